// SPDX-License-Identifier: MIT
// OpenPTV's working folders: which files make a rig, and a rig as such files.
#include <fmt/format.h>

#include <cmath>
#include <fstream>

#include "calibration/cameras/openptv.hpp"
#include "calibration/space_algebra.hpp"
#include "core/error.hpp"
#include "core/quote.hpp"
#include "core/text_file.hpp"

namespace rptv {

namespace {

namespace fs = std::filesystem;

fs::path find_setup(const fs::path& place) {
  std::error_code error;
  if (!fs::is_directory(place, error)) return place;
  const fs::path below = place / "parameters" / "ptv.par";
  return fs::exists(below, error) ? below : place / "ptv.par";
}

/// liboptv runs in the folder that holds `parameters`, and names count from there.
fs::path find_ori(const fs::path& setup_file, const std::string& image) {
  const fs::path own = fs::absolute(setup_file).parent_path();
  std::error_code error;
  for (const fs::path& folder : {own.parent_path(), own})
    if (fs::exists(folder / (image + ".ori"), error)) return folder / image;
  throw Error(ExitCode::no_input,
              fmt::format("{}: names {} and there is no {}.ori in {} or {}; copy the cal folder too",
                          setup_file.string(), in_quotes(image), image, own.parent_path().string(), own.string()));
}

OpenptvCamera read_camera(const fs::path& image) {
  const std::string ori = image.string() + ".ori", addpar = image.string() + ".addpar";
  OpenptvCamera camera = parse_openptv_ori(read_text_file(ori, "give OpenPTV's orientation file"), ori);
  std::error_code error;
  if (fs::exists(addpar, error))
    parse_openptv_addpar(read_text_file(addpar, "give OpenPTV's distortion file"), addpar, camera);
  return camera;
}

std::vector<std::string> warnings_of(const OpenptvSetup& setup, const std::string& file) {
  if (!(setup.index_glass > 1 && setup.index_glass < setup.index_behind)) return {};
  return {
      fmt::format("{}: says index {} for the glass and {} behind it; liboptv reads them in this order, and so does "
                  "this, but most glasses are above most liquids: are they swapped?",
                  file, setup.index_glass, setup.index_behind)};
}

void check_alike(const OpenptvSetup& one, const OpenptvSetup& first, const std::string& origin) {
  if (one.width_px != first.width_px || one.height_px != first.height_px)
    throw Error(
        ExitCode::configuration,
        fmt::format("{}: has {}x{} px and the first camera {}x{}, but ptv.par has one size; export cameras of one "
                    "size",
                    origin, one.width_px, one.height_px, first.width_px, first.height_px));
  const auto differ = [](double a, double b) { return std::abs(a - b) > 1e-9; };
  if (differ(one.index_before, first.index_before) || differ(one.index_glass, first.index_glass) ||
      differ(one.index_behind, first.index_behind) || differ(one.glass_mm, first.glass_mm))
    throw Error(ExitCode::configuration,
                origin +
                    ": sees through other media than the first camera, but ptv.par has one set; export cameras of one "
                    "tank");
}

void write_text(const fs::path& file, const std::string& text) {
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  if (!stream.flush())
    throw Error(ExitCode::io, fmt::format("{}: cannot be written; check folder, permissions and space", file.string()));
}

}  // namespace

OpenptvImport import_openptv(const fs::path& place, OpenptvScale scale) {
  const fs::path file = find_setup(place);
  const OpenptvSetup setup =
      parse_openptv_setup(read_text_file(file, "give OpenPTV's ptv.par, or the folder that holds it"), file.string());
  OpenptvImport result;
  result.warnings = warnings_of(setup, file.string());
  for (const std::string& name : setup.calibration_images) {
    const fs::path image = find_ori(file, name);
    const OpenptvCamera camera = read_camera(image);
    const std::string ori = image.string() + ".ori";
    if (camera.scale_x != 1)
      result.warnings.push_back(
          fmt::format("{}: scx = {} scales {}; liboptv took it for the columns alone until March 2025, for both axes "
                      "since (--scale)",
                      ori, camera.scale_x, scale == OpenptvScale::both ? "both axes" : "the columns alone"));
    for (const RigCamera& other : result.rig.cameras)
      if (other.name == image.stem().string())
        throw Error(ExitCode::configuration, fmt::format("{}: names two calibration images {}; rename one",
                                                         file.string(), in_quotes(other.name)));
    result.rig.cameras.push_back({image.stem().string(), from_openptv(camera, setup, scale, ori)});
  }
  return result;
}

std::vector<double> export_openptv(const Rig& rig, double pixel_mm, const fs::path& folder, const std::string& origin) {
  OpenptvSetup first;
  std::vector<OpenptvExport> cameras;
  for (const RigCamera& camera : rig.cameras) {
    const std::string where = fmt::format("{}: camera {}", origin, in_quotes(camera.name));
    if (camera.name.find_first_of(" \t\n/") != std::string::npos)
      throw Error(ExitCode::configuration,
                  where + " has a space or a / in its name, which ptv.par cannot hold; rename it");
    OpenptvSetup setup;
    cameras.push_back(to_openptv(camera.model, pixel_mm, setup, where));
    if (cameras.size() > 1) check_alike(setup, first, where);
    if (cameras.size() == 1) first = setup;
    first.images.push_back("img/" + camera.name + ".");
    first.calibration_images.push_back("cal/" + camera.name + ".tif");
  }
  write_text(folder / "parameters" / "ptv.par", openptv_setup(first));
  std::vector<double> worst_px;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    write_text(folder / (first.calibration_images[i] + ".ori"), openptv_ori(cameras[i].camera));
    write_text(folder / (first.calibration_images[i] + ".addpar"), openptv_addpar(cameras[i].camera));
    worst_px.push_back(cameras[i].worst_px);
  }
  return worst_px;
}

}  // namespace rptv
