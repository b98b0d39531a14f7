// SPDX-License-Identifier: MIT
// A rig's cameras as settings fields, one section each, and back.
#include "calibration/cameras/rig.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <set>

#include "core/error.hpp"
#include "core/quote.hpp"
#include "core/settings.hpp"

namespace rptv {
namespace {

constexpr double kLargest = 1e12;

/// One camera as its section of the file has it.
struct CameraSection {
  std::string name;
  std::int64_t width_px = 0, height_px = 0;
  CameraIntrinsics lens;
  std::vector<double> rotation, translation_mm, normal, positions_mm, indices;

  void fields(FieldList& list) {
    list.text("name", name, "what frames and folders call the camera").required = true;
    list.integer("width_px", width_px, 1, 65536, "columns of its images").required = true;
    list.integer("height_px", height_px, 1, 65536, "rows of its images").required = true;
    list.number("fx_px", lens.fx_px, 1e-6, kLargest, "focal length over the pixels' width").required = true;
    list.number("fy_px", lens.fy_px, 1e-6, kLargest, "focal length over the pixels' height").required = true;
    list.number("cx_px", lens.cx_px, -kLargest, kLargest, "column of the centre of distortion").required = true;
    list.number("cy_px", lens.cy_px, -kLargest, kLargest, "its row; pixel centres are integers").required = true;
    list.number("skew_px", lens.skew_px, -kLargest, kLargest, "columns per focal length of row");
    list.number("k1", lens.k1, -kLargest, kLargest, "radial distortion (Brown, as OpenCV)");
    list.number("k2", lens.k2, -kLargest, kLargest, "radial distortion, fourth power");
    list.number("k3", lens.k3, -kLargest, kLargest, "radial distortion, sixth power");
    list.number("p1", lens.p1, -kLargest, kLargest, "decentring distortion, mostly of rows");
    list.number("p2", lens.p2, -kLargest, kLargest, "decentring distortion, mostly of columns");
    list.number("offset_x", lens.offset_x, -kLargest, kLargest,
                "optical axis right of the centre of distortion, in focal lengths");
    list.number("offset_y", lens.offset_y, -kLargest, kLargest, "optical axis below the centre of distortion");
    list.numbers("rotation", rotation, 9, -2, 2, "x_camera = rotation x_rig + translation; row by row").required = true;
    list.numbers("translation_mm", translation_mm, 3, -kLargest, kLargest, "the rig's origin, from the camera")
        .required = true;
    list.numbers("interface_normal", normal, 0, -2, 2,
                 "unit vector across the plane interfaces, towards the camera; empty: no interfaces");
    list.numbers("interface_positions_mm", positions_mm, 0, -kLargest, kLargest,
                 "where they are along the normal, from the rig's origin; nearest the camera first");
    list.numbers("media_indices", indices, 0, 1, 4,
                 "refractive indices: the camera's medium, then behind each interface");
  }

  bool given() const {
    return !name.empty() || width_px != 0 || height_px != 0 || lens.fx_px != 0 || !rotation.empty();
  }

  RigCamera camera(const std::string& origin) const {
    CameraIntrinsics intrinsics = lens;
    intrinsics.width_px = static_cast<int>(width_px), intrinsics.height_px = static_cast<int>(height_px);
    CameraPose pose;
    for (std::size_t k = 0; k < 9; ++k) pose.rotation[k / 3][k % 3] = rotation[k];
    std::copy_n(translation_mm.begin(), 3, pose.translation_mm.begin());
    return {name, CameraModel(intrinsics, pose, stack(origin), origin)};
  }

  RefractiveStack stack(const std::string& origin) const {
    if (normal.empty() && positions_mm.empty() && indices.empty()) return {};
    if (normal.size() != 3 || indices.size() != positions_mm.size() + 1)
      throw Error(
          ExitCode::configuration,
          fmt::format("{}: interface_normal has {} numbers, interface_positions_mm {} and media_indices {}; give "
                      "3, one per interface, and one more than interfaces",
                      origin, normal.size(), positions_mm.size(), indices.size()));
    RefractiveStack stack{{normal[0], normal[1], normal[2]}, {indices[0]}, {}};
    for (std::size_t i = 0; i < positions_mm.size(); ++i)
      stack.interfaces.push_back({positions_mm[i], {indices[i + 1]}});
    return stack;
  }
};

CameraSection section_of(const RigCamera& camera) {
  CameraSection section;
  section.name = camera.name;
  section.lens = camera.model.intrinsics();
  section.width_px = section.lens.width_px, section.height_px = section.lens.height_px;
  for (const auto& row : camera.model.pose().rotation)
    section.rotation.insert(section.rotation.end(), row.begin(), row.end());
  const auto& translation = camera.model.pose().translation_mm;
  section.translation_mm.assign(translation.begin(), translation.end());
  const RefractiveStack& stack = camera.model.stack();
  if (stack.interfaces.empty() && stack.before.index == 1) return section;
  section.normal.assign(stack.normal.begin(), stack.normal.end());
  section.indices.push_back(stack.before.index);
  for (const auto& interface : stack.interfaces) {
    section.positions_mm.push_back(interface.position_mm);
    section.indices.push_back(interface.behind.index);
  }
  return section;
}

std::string section_name(std::size_t i) { return "camera_" + std::to_string(i + 1); }

using Sections = std::array<CameraSection, Rig::kMostCameras>;

FieldList fields_of(Sections& sections, std::size_t count) {
  FieldList list;
  for (std::size_t i = 0; i < count; ++i) list.section(section_name(i), sections[i]);
  return list;
}

/// Two readings: the first finds how many cameras the file has, the second says where something of theirs is missing.
template <class Read>
Rig read_with(Read read, const std::string& origin) {
  Sections sections;
  FieldList any = fields_of(sections, Rig::kMostCameras);
  any.require_nothing();
  read(any);
  std::size_t count = Rig::kMostCameras;
  while (count > 0 && !sections[count - 1].given()) --count;
  if (count == 0)
    throw Error(ExitCode::configuration,
                origin + ": has no camera; add [camera_1] or make the file with `rapidptv calibrate`");
  FieldList exact = fields_of(sections, count);
  read(exact);
  Rig rig;
  std::set<std::string> names;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string where = origin + ": " + section_name(i);
    if (sections[i].name.empty()) throw Error(ExitCode::configuration, where + ".name is empty; name the camera");
    if (!names.insert(sections[i].name).second)
      throw Error(ExitCode::configuration,
                  fmt::format("{}.name {} is another camera's; names must differ", where, in_quotes(sections[i].name)));
    rig.cameras.push_back(sections[i].camera(where));
  }
  return rig;
}

}  // namespace

Rig read_rig(const std::filesystem::path& file) {
  return read_with([&](FieldList& list) { read_toml_file(file, "rig", Rig::kSchema, list); }, file.string());
}

Rig parse_rig(std::string_view text, const std::string& origin) {
  return read_with([&](FieldList& list) { read_toml_text(text, origin, "rig", Rig::kSchema, list); }, origin);
}

std::string to_toml(const Rig& rig) {
  Sections sections;
  const std::size_t count = std::min(rig.cameras.size(), Rig::kMostCameras);
  for (std::size_t i = 0; i < count; ++i) sections[i] = section_of(rig.cameras[i]);
  return to_toml(fields_of(sections, count), Rig::kSchema);
}

void write_rig(const Rig& rig, const std::filesystem::path& file) {
  std::ofstream stream(file, std::ios::binary);
  stream << to_toml(rig);
  if (!stream.flush())
    throw Error(ExitCode::io, fmt::format("{}: cannot be written; check folder, permissions and space", file.string()));
}

void check_resolution(const RigCamera& camera, int width_px, int height_px, const std::string& origin) {
  const auto& lens = camera.model.intrinsics();
  if (lens.width_px == width_px && lens.height_px == height_px) return;
  throw Error(
      ExitCode::configuration,
      fmt::format("{}: camera {} is calibrated for {}x{} px and its images have {}x{}; use the region of interest "
                  "that it was calibrated with, or calibrate it as it is now",
                  origin, in_quotes(camera.name), lens.width_px, lens.height_px, width_px, height_px));
}

}  // namespace rptv
