// SPDX-License-Identifier: MIT
// OpenCV's storage, read entry by entry under the names that are in use; the only translation unit with
// cv::FileStorage.
#include "calibration/cameras/opencv_yaml.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <optional>
#include <span>

#include "calibration/space_algebra.hpp"
#include "core/error.hpp"
#include "core/quote.hpp"
#include "core/text_file.hpp"

namespace rptv {
namespace {

using Names = std::span<const char* const>;

class Storage {
 public:
  Storage(const std::string& text, const std::string& origin) : origin_(origin) {
    try {
      storage_.open(text, cv::FileStorage::READ | cv::FileStorage::MEMORY);
    } catch (const cv::Exception& error) {
      refuse("is no file of OpenCV's (" + in_quotes(error.err, 200) + "); mend it");
    }
    if (!storage_.isOpened() || !storage_.root().isMap()) refuse("is no YAML, XML or JSON file of OpenCV's; mend it");
  }

  /// The numbers of a matrix or list, row by row; none when no such entry is there.
  std::optional<std::vector<double>> numbers(Names names) const {
    const cv::FileNode node = find(names);
    if (node.empty()) return {};
    const cv::FileNode list = node.isMap() ? node["data"] : node;
    std::vector<double> values;
    if (list.isInt() || list.isReal()) values.push_back(list.real());
    if (list.isSeq())
      for (const cv::FileNode& element : list) {
        if (!element.isInt() && !element.isReal())
          refuse(fmt::format("{} holds what is no number; mend it", name_of(names)));
        values.push_back(element.real());
      }
    for (const double value : values)
      if (!std::isfinite(value)) refuse(fmt::format("{} holds {}; every number must be finite", name_of(names), value));
    return values;
  }

  std::vector<double> need(Names names, std::size_t size) const {
    const auto values = numbers(names);
    if (!values) refuse(fmt::format("has no {}; add it (or one of: {})", names.front(), fmt::join(names, ", ")));
    if (values->size() != size) refuse(fmt::format("{} has {} numbers; give {}", name_of(names), values->size(), size));
    return *values;
  }

  std::string text(const char* name) const {
    const cv::FileNode node = storage_[name];
    return node.isString() ? node.string() : "";
  }

  [[noreturn]] void refuse(const std::string& what) const { throw Error(ExitCode::bad_data, origin_ + ": " + what); }

 private:
  cv::FileNode find(Names names) const {
    for (const char* name : names)
      if (const cv::FileNode node = storage_[name]; !node.empty()) return node;
    return {};
  }
  std::string name_of(Names names) const {
    for (const char* name : names)
      if (!storage_[name].empty()) return in_quotes(name);
    return "";
  }

  cv::FileStorage storage_;
  const std::string& origin_;
};

constexpr const char* kSize[]{"image_size", "imageSize", "img_size"};
constexpr const char* kWidth[]{"image_width", "image_Width", "width"};
constexpr const char* kHeight[]{"image_height", "image_Height", "height"};
constexpr const char* kMatrix[]{"camera_matrix", "cameraMatrix", "K", "intrinsic_matrix"};
constexpr const char* kRotation[]{"R", "rotation_matrix", "rotation"};
constexpr const char* kRotationVector[]{"rvec", "rotation_vector"};
constexpr const char* kTranslation[]{"T", "tvec", "t", "translation", "translation_vector"};
constexpr const char* kDistortion[]{"distortion_coefficients", "distCoeffs", "dist_coeffs", "D", "distortion"};

/// Rodrigues: a turn by |v| about v.
Matrix3 rotation_about(const Point3& v) {
  const double angle = norm(v);
  if (angle == 0) return CameraPose{}.rotation;
  const Point3 axis = (1 / angle) * v;
  const double sine = std::sin(angle), rest = 1 - std::cos(angle);
  Matrix3 m;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) m[i][j] = (i == j ? 1 - rest : 0) + rest * axis[i] * axis[j];
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    m[k][j] += sine * axis[i], m[j][k] -= sine * axis[i];
  }
  return m;
}

CameraPose pose_of(const Storage& storage, double unit_mm) {
  CameraPose pose;
  const auto matrix = storage.numbers(kRotation), vector = storage.numbers(kRotationVector);
  const auto translation = storage.numbers(kTranslation);
  if (!matrix && !vector && !translation) return pose;
  if (!translation || !(matrix || vector))
    storage.refuse(translation ? "has T and no R; give both, or none for the camera that is the frame"
                               : "has R and no T; give both, or none for the camera that is the frame");
  const auto turn = matrix ? *matrix : *vector;
  if (turn.size() == 9)
    for (std::size_t k = 0; k < 9; ++k) pose.rotation[k / 3][k % 3] = turn[k];
  else if (turn.size() == 3)
    pose.rotation = rotation_about({turn[0], turn[1], turn[2]});
  else
    storage.refuse(fmt::format("its rotation has {} numbers; give a matrix of 9 or a vector of 3", turn.size()));
  const auto t = storage.need(kTranslation, 3);
  pose.translation_mm = {unit_mm * t[0], unit_mm * t[1], unit_mm * t[2]};
  return pose;
}

void read_distortion(const Storage& storage, CameraIntrinsics& lens) {
  const std::string model = storage.text("distortion_model");
  if (!model.empty() && model != "plumb_bob" && model != "rational_polynomial" && model != "brown")
    storage.refuse("distortion_model " + in_quotes(model) + " is not Brown's; calibrate again without fisheye");
  auto factors = storage.numbers(kDistortion).value_or(std::vector<double>{});
  if (factors.size() > 14) storage.refuse(fmt::format("has {} distortion coefficients; give 4 or 5", factors.size()));
  factors.resize(14);
  for (std::size_t k = 5; k < 14; ++k)
    if (factors[k] != 0)
      storage.refuse(
          fmt::format("distortion coefficient {} is {}, of the rational, thin-prism or tilted model; calibrate "
                      "again with 5 coefficients",
                      k + 1, factors[k]));
  lens.k1 = factors[0], lens.k2 = factors[1], lens.p1 = factors[2], lens.p2 = factors[3], lens.k3 = factors[4];
}

int side_of(const Storage& storage, double value) {
  if (!(value >= 1 && value <= 65536) || value != std::floor(value))
    storage.refuse(fmt::format("an image side of {} px is no whole number from 1 to 65536; mend it", value));
  return static_cast<int>(value);
}

}  // namespace

CameraModel parse_opencv_camera(const std::string& text, double unit_mm, const std::string& origin) {
  const Storage storage(text, origin);
  CameraIntrinsics lens;
  const auto size = storage.numbers(kSize);
  if (size && size->size() != 2) storage.refuse("its image size is not [columns, rows]; mend it");
  lens.width_px = side_of(storage, size ? size->at(0) : storage.need(kWidth, 1)[0]);
  lens.height_px = side_of(storage, size ? size->at(1) : storage.need(kHeight, 1)[0]);
  const auto k = storage.need(kMatrix, 9);
  if (k[3] != 0 || k[6] != 0 || k[7] != 0 || k[8] != 1)
    storage.refuse("its camera matrix is not [fx, skew, cx; 0, fy, cy; 0, 0, 1]; mend it");
  lens.fx_px = k[0], lens.skew_px = k[1], lens.cx_px = k[2], lens.fy_px = k[4], lens.cy_px = k[5];
  read_distortion(storage, lens);
  return CameraModel(lens, pose_of(storage, unit_mm), {}, origin);
}

Rig import_opencv(const std::vector<std::filesystem::path>& files, double unit_mm) {
  Rig rig;
  if (files.empty() || files.size() > Rig::kMostCameras)
    throw Error(ExitCode::usage,
                fmt::format("{} files; give one per camera, 1 to {}", files.size(), Rig::kMostCameras));
  for (const auto& file : files) {
    const std::string name = file.stem().string();
    for (const RigCamera& other : rig.cameras)
      if (other.name == name)
        throw Error(ExitCode::usage,
                    fmt::format("{}: another file is called {} too; rename one", file.string(), in_quotes(name)));
    rig.cameras.push_back({name, parse_opencv_camera(read_text_file(file, "give OpenCV's calibration of one camera"),
                                                     unit_mm, file.string())});
  }
  return rig;
}

}  // namespace rptv
