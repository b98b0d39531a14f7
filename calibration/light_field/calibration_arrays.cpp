// SPDX-License-Identifier: MIT
// Calibration arrays in HDF5; the only translation unit of this folder that sees the HDF5 library.
#include "calibration/light_field/calibration_arrays.hpp"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "core/error.hpp"

namespace rptv {

namespace {

constexpr hsize_t kMostValues = hsize_t{1} << 28;
constexpr std::int64_t kFarthest = 1'000'000'000;
constexpr float kMostAmount = 1e6F;  // grey values, or shares of light
constexpr const char* kAgain = "make it again with `rapidptv calibrate lenslets`";

/// An HDF5 identifier that is closed once. Below 0: the call failed.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) noexcept : id_(id), close_(close) {}
  Handle(Handle&& other) noexcept : id_(other.id_), close_(other.close_) { other.id_ = -1; }
  Handle& operator=(Handle&&) = delete;
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const noexcept { return id_; }
  bool ok() const noexcept { return id_ >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

void keep_quiet() noexcept { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

struct Type {
  hid_t on_disk, in_memory;
};
Type type_of(const std::uint8_t*) { return {H5T_STD_U8LE, H5T_NATIVE_UINT8}; }
Type type_of(const float*) { return {H5T_IEEE_F32LE, H5T_NATIVE_FLOAT}; }

bool put_text(hid_t object, const char* name, const std::string& text) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, text.size());
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  return attribute.ok() && H5Awrite(attribute, type, text.data()) >= 0;
}

bool put_integer(hid_t object, const char* name, std::int64_t value) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(H5Acreate2(object, name, H5T_STD_I64LE, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  return attribute.ok() && H5Awrite(attribute, H5T_NATIVE_INT64, &value) >= 0;
}

std::int64_t integer_of(hid_t object, const char* name) {
  std::int64_t value = 0;
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  if (attribute.ok()) H5Aread(attribute, H5T_NATIVE_INT64, &value);
  return value;
}

class Writing {
 public:
  explicit Writing(const std::filesystem::path& path)
      : path_(path), file_(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose) {
    check(file_.ok());
  }

  template <class Value>
  void put(const char* name, const std::vector<Value>& values, hsize_t rows, hsize_t columns, const char* units,
           const LensletMask* grid) {
    const std::array<hsize_t, 2> shape{rows, columns};
    const Handle space(H5Screate_simple(2, shape.data(), nullptr), H5Sclose);
    const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_chunk(creation, 2, shape.data());
    H5Pset_deflate(creation, 1);
    const Type type = type_of(values.data());
    const Handle set(H5Dcreate2(file_, name, type.on_disk, space, H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose);
    check(set.ok() && H5Dwrite(set, type.in_memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >= 0 &&
          put_text(set, "units", units));
    if (grid != nullptr)
      check(put_integer(set, "first_u", grid->first_u) && put_integer(set, "first_v", grid->first_v));
  }
  void finish() { check(H5Fflush(file_, H5F_SCOPE_GLOBAL) >= 0); }

 private:
  void check(bool ok) const {
    if (!ok)
      throw Error(ExitCode::io,
                  fmt::format("{}: cannot be written as HDF5; check folder, permissions and space", path_.string()));
  }
  const std::filesystem::path& path_;
  Handle file_;
};

class Reading {
 public:
  explicit Reading(const std::filesystem::path& path)
      : path_(path), file_(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose) {
    if (!std::filesystem::exists(path))
      throw Error(ExitCode::no_input,
                  fmt::format("{}: does not exist, but the calibration names it in lenslets.arrays; "
                              "copy it beside the calibration, or {}",
                              path.string(), kAgain));
    if (!file_.ok()) refuse("is not an HDF5 file");
  }

  bool has(const char* name) const { return H5Lexists(file_, name, H5P_DEFAULT) > 0; }

  template <class Value>
  void take(const char* name, std::vector<Value>& values, std::array<std::int64_t, 2>& shape, LensletMask* grid) const {
    const Handle set(H5Dopen2(file_, name, H5P_DEFAULT), H5Dclose);
    if (!set.ok()) refuse(fmt::format("has no dataset '{}'", name));
    const Handle space(H5Dget_space(set), H5Sclose);
    std::array<hsize_t, 2> extent{};
    if (H5Sget_simple_extent_ndims(space) != 2 || H5Sget_simple_extent_dims(space, extent.data(), nullptr) != 2 ||
        extent[0] == 0 || extent[1] == 0 || extent[0] > kMostValues / extent[1])
      refuse(fmt::format("dataset '{}' is not a table of rows and columns", name));
    values.resize(extent[0] * extent[1]);
    if (H5Dread(set, type_of(values.data()).in_memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
      refuse(fmt::format("dataset '{}' cannot be read", name));
    shape = {static_cast<std::int64_t>(extent[0]), static_cast<std::int64_t>(extent[1])};
    if (grid == nullptr) return;
    grid->first_u = integer_of(set, "first_u"), grid->first_v = integer_of(set, "first_v");
    grid->rows = shape[0], grid->columns = shape[1];
    for (const auto first : {grid->first_u, grid->first_v})
      if (first < -kFarthest || first > kFarthest)
        refuse(fmt::format("dataset '{}' begins at lenslet {}", name, first));
  }

  void take_amounts(const char* name, std::vector<float>& values, std::array<std::int64_t, 2>& shape) const {
    take(name, values, shape, nullptr);
    const auto wrong = std::find_if(values.begin(), values.end(), [](float v) { return !(v >= 0 && v < kMostAmount); });
    if (wrong != values.end()) refuse(fmt::format("dataset '{}' has the value {}", name, *wrong));
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(ExitCode::bad_data, fmt::format("{}: {}; {}", path_.string(), what, kAgain));
  }

 private:
  const std::filesystem::path& path_;
  Handle file_;
};

}  // namespace

void write_calibration_arrays(const CalibrationArrays& arrays, const std::filesystem::path& file) {
  keep_quiet();
  Writing writing(file);
  const auto rows = static_cast<hsize_t>(arrays.fit.rows), columns = static_cast<hsize_t>(arrays.fit.columns);
  const char* bits = "bits: 1 area, 2 eccentricity, 4 residual, 8 brightness, 16 border";
  writing.put("fit_reason", arrays.fit.reasons, rows, columns, bits, &arrays.fit);
  writing.put("ray_reason", arrays.ray.reasons, rows, columns, bits, &arrays.ray);
  writing.put("vignetting", arrays.vignetting, rows, columns, "1", &arrays.fit);
  if (!arrays.area.empty()) writing.put("area", arrays.area, rows, columns, "1", &arrays.fit);
  if (!arrays.dark_level.empty()) {
    writing.put("dark_level", arrays.dark_level, arrays.height_px, arrays.width_px, "grey value", nullptr);
    writing.put("dark_noise", arrays.dark_noise, arrays.height_px, arrays.width_px, "grey value", nullptr);
  }
  writing.finish();
}

CalibrationArrays read_calibration_arrays(const std::filesystem::path& file) {
  keep_quiet();
  const Reading reading(file);
  CalibrationArrays arrays;
  std::array<std::int64_t, 2> shape{}, same{};
  reading.take("ray_reason", arrays.ray.reasons, shape, &arrays.ray);
  if (reading.has("fit_reason")) {
    reading.take("fit_reason", arrays.fit.reasons, same, &arrays.fit);
    if (same != shape) reading.refuse("'fit_reason' has another shape than 'ray_reason'");
  }
  for (const auto& [name, values] : {std::pair{"vignetting", &arrays.vignetting}, {"area", &arrays.area}}) {
    if (!reading.has(name)) continue;
    reading.take_amounts(name, *values, same);
    if (same != shape) reading.refuse(fmt::format("'{}' has another shape than 'ray_reason'", name));
  }
  if (!reading.has("dark_level")) return arrays;
  reading.take_amounts("dark_level", arrays.dark_level, shape);
  reading.take_amounts("dark_noise", arrays.dark_noise, same);
  if (same != shape) reading.refuse("'dark_noise' has another shape than 'dark_level'");
  arrays.height_px = static_cast<std::uint32_t>(shape[0]), arrays.width_px = static_cast<std::uint32_t>(shape[1]);
  return arrays;
}

}  // namespace rptv
