// SPDX-License-Identifier: MIT
// File names by a pattern; images by replay/, targets in them by calibration/.
#include "daemon/board_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <regex>
#include <set>

#include "calibration/cameras/board_image.hpp"
#include "calibration/cameras/rig.hpp"
#include "core/error.hpp"
#include "core/quote.hpp"
#include "replay/image_file.hpp"
#include "replay/natural_order.hpp"

namespace rptv {

namespace {

namespace fs = std::filesystem;

/// The pattern as a regular expression over the last components of a path.
struct NamePattern {
  std::regex expression;
  std::size_t components = 1, camera = 1, view = 2;  // groups
  std::string before_camera;                         // of the camera's path component, when it says something

  explicit NamePattern(const std::string& pattern) {
    const std::string kCamera = "{camera}", kView = "{view}";
    const std::size_t camera_at = pattern.find(kCamera), view_at = pattern.find(kView);
    if (camera_at == std::string::npos || view_at == std::string::npos)
      throw Error(ExitCode::usage, fmt::format("pattern {} has no {{camera}} or no {{view}}; write for instance "
                                               "cam{{camera}}_{{view}}.png",
                                               in_quotes(pattern)));
    if (view_at < camera_at) std::swap(camera, view);
    const std::size_t begin = pattern.rfind('/', camera_at) + 1;  // npos + 1: the pattern's own
    before_camera = pattern.substr(begin, camera_at - begin);
    if (before_camera.find_first_of("*{") != std::string::npos) before_camera.clear();
    std::string text;
    for (std::size_t i = 0; i < pattern.size();) {
      const bool is_camera = i == camera_at;
      if (is_camera || i == view_at) {
        text += "([^/]+?)", i += (is_camera ? kCamera : kView).size();
        continue;
      }
      const char c = pattern[i++];
      if (c == '/') ++components;
      if (c == '*') {
        text += "[^/]*";
        continue;
      }
      if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '/' && c != '_') text += '\\';
      text += c;
    }
    expression = std::regex(text);
  }
};

/// The last `count` components of a path, joined by slashes.
std::string tail_of(const fs::path& file, std::size_t count) {
  const std::vector<fs::path> parts(file.begin(), file.end());
  fs::path tail;
  for (std::size_t i = parts.size() - std::min(count, parts.size()); i < parts.size(); ++i) tail /= parts[i];
  return tail.generic_string();
}

std::vector<fs::path> files_under(const std::string& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return {path};
  std::vector<fs::path> files;
  for (fs::recursive_directory_iterator entry(path, error), end; !error && entry != end; entry.increment(error))
    if (entry->is_regular_file(error)) files.push_back(entry->path());
  if (error)
    throw Error(ExitCode::io, fmt::format("{}: cannot be listed ({}); check its permissions", path, error.message()));
  return files;
}

/// What one file shows; the first of a camera says how large its images are.
BoardView look(const BoardFile& entry, const Board& board, CameraImages& camera, const std::vector<int>& size_px) {
  BoardView image{0, 0, entry.file.string(), {}};
  const auto refuse = [&](const std::string& text) { throw Error(ExitCode::bad_data, image.origin + ": " + text); };
  if (board.kind == "points") {
    if (size_px.size() != 2)
      throw Error(ExitCode::usage,
                  "points that were measured do not tell how large the images are; give --size WIDTH HEIGHT");
    camera.width_px = size_px[0], camera.height_px = size_px[1];
    image.seen = read_seen_points(entry.file, board);
    return image;
  }
  const auto reader = open_image(entry.file);
  const ImageHeader& header = reader->header(0);
  const int width = static_cast<int>(header.shape.width_px), height = static_cast<int>(header.shape.height_px);
  if (camera.width_px == 0) camera.width_px = width, camera.height_px = height;
  if (width != camera.width_px || height != camera.height_px)
    refuse(
        fmt::format("is {}x{} px and the images of camera {} before it are {}x{}; calibrate with images of one region "
                    "of interest and binning",
                    width, height, entry.camera, camera.width_px, camera.height_px));
  std::vector<std::byte> pixels(header.shape.bytes());
  reader->decode(0, pixels);
  const ImageView view{pixels.data(), header.shape};
  check_board_image(view, header.significant_bits, image.origin);
  image.seen = find_board(view, board);
  return image;
}

template <class List, class Name>
std::size_t place_of(const List& list, const Name& is_it) {
  return static_cast<std::size_t>(std::find_if(list.begin(), list.end(), is_it) - list.begin());
}

}  // namespace

std::vector<BoardFile> find_board_files(const std::vector<std::string>& paths, const std::string& pattern) {
  const NamePattern names(pattern);
  std::vector<BoardFile> found;
  for (const auto& path : paths)
    for (const auto& file : files_under(path)) {
      std::smatch match;
      const std::string tail = tail_of(file, names.components);
      if (std::regex_match(tail, match, names.expression))
        found.push_back({names.before_camera + match[names.camera].str(), match[names.view].str(), file});
    }
  if (found.empty())
    throw Error(ExitCode::no_input, fmt::format("{}: no file is named like {}; give --pattern with {{camera}} and "
                                                "{{view}} where the names have them",
                                                paths.front(), in_quotes(pattern)));
  const auto before = [](const BoardFile& a, const BoardFile& b) {
    return a.camera != b.camera ? naturally_less(a.camera, b.camera) : naturally_less(a.view, b.view);
  };
  std::sort(found.begin(), found.end(), before);
  for (std::size_t i = 1; i < found.size(); ++i)
    if (!before(found[i - 1], found[i]))
      throw Error(ExitCode::bad_data,
                  fmt::format("{} and {} are both view {} of camera {}; give one of them", found[i - 1].file.string(),
                              found[i].file.string(), found[i].view, found[i].camera));
  if (found.front().camera == found.back().camera)
    throw Error(ExitCode::bad_data, fmt::format("{}: all files are of camera {}; a rig has two or more", paths.front(),
                                                found.front().camera));
  return found;
}

BoardSet read_board_set(const std::vector<BoardFile>& files, const Board& board, const std::vector<int>& size_px,
                        bool allow_missing, const std::function<void()>& looked) {
  BoardSet set;
  set.target_mm = board.points();
  std::set<std::string, decltype(&naturally_less)> views(&naturally_less);
  for (const auto& entry : files) {
    views.insert(entry.view);
    if (set.cameras.empty() || set.cameras.back().name != entry.camera) set.cameras.push_back({entry.camera, 0, 0});
  }
  if (set.cameras.size() > Rig::kMostCameras)
    throw Error(ExitCode::bad_data,
                fmt::format("{} and the others are of {} cameras and a rig has at most {}; check what "
                            "--pattern takes for the camera's name",
                            files.front().file.string(), set.cameras.size(), Rig::kMostCameras));
  set.views.assign(views.begin(), views.end());
  for (const auto& camera : set.cameras)
    for (const auto& view : set.views)
      if (!allow_missing && place_of(files, [&](const BoardFile& f) {
                              return f.camera == camera.name && f.view == view;
                            }) == files.size())
        throw Error(ExitCode::bad_data, fmt::format("camera {} has no image of view {} and others have; name files of "
                                                    "one moment alike, or give --allow-missing",
                                                    camera.name, view));
  std::size_t points = 0;
  for (const auto& entry : files) {
    const std::size_t camera = place_of(set.cameras, [&](const CameraImages& c) { return c.name == entry.camera; });
    BoardView image = look(entry, board, set.cameras[camera], size_px);
    image.camera = camera, image.view = place_of(set.views, [&](const std::string& v) { return v == entry.view; });
    points += image.seen.size();
    set.images.push_back(std::move(image));
    looked();
  }
  if (points == 0)
    throw Error(ExitCode::bad_data, fmt::format("{} and the others show no part of the board; check its file: kind, "
                                                "columns, rows, marker set",
                                                files.front().file.string()));
  return set;
}

}  // namespace rptv
