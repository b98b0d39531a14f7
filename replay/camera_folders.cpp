// SPDX-License-Identifier: MIT
// Finds which images under a path belong to which camera.
#include <fnmatch.h>

#include <algorithm>
#include <map>

#include "core/frame.hpp"
#include "replay/image_error.hpp"
#include "replay/image_sequence.hpp"
#include "replay/natural_order.hpp"

namespace rptv {
namespace {

namespace fs = std::filesystem;
using Files = std::vector<fs::path>;

struct Listing {
  Files images;
  std::map<std::uint64_t, fs::path> cameras;  ///< sub-folders camK by K
};

bool is_image(const fs::path& file) {
  std::string end = file.extension().string();
  std::transform(end.begin(), end.end(), end.begin(), [](unsigned char c) { return std::tolower(c); });
  return file.filename().string().front() != '.' && (end == ".png" || end == ".tif" || end == ".tiff");
}

Listing list(const fs::path& folder) {
  Listing found;
  std::error_code code;
  fs::directory_iterator entry(folder, code);
  for (; !code && entry != fs::directory_iterator(); entry.increment(code)) {
    const fs::path& path = entry->path();
    const auto number = camera_number(path.filename().string());
    std::error_code ignored;
    if (fs::is_directory(path, ignored)) {
      if (number && path.filename().string().find('_') == std::string::npos &&
          !found.cameras.emplace(*number, path).second)
        throw image_error(path, "is a second folder for camera " + std::to_string(*number), "rename one of them");
    } else if (is_image(path)) {
      found.images.push_back(path);
    }
  }
  if (code) throw system_error(folder, code.value(), "listed");
  std::sort(found.images.begin(), found.images.end(), [](const fs::path& a, const fs::path& b) {
    return naturally_less(a.filename().string(), b.filename().string());
  });
  return found;
}

template <class Condition>
Files those(const Files& files, Condition condition) {
  Files chosen;
  std::copy_if(files.begin(), files.end(), std::back_inserter(chosen),
               [&](const fs::path& file) { return condition(file.filename().string()); });
  return chosen;
}

bool starts_with_any(const std::string& name, std::initializer_list<std::string_view> prefixes) {
  return std::any_of(prefixes.begin(), prefixes.end(),
                     [&](std::string_view prefix) { return name.compare(0, prefix.size(), prefix) == 0; });
}

bool is_camera_file(const std::string& name) { return camera_number(fs::path(name).stem().string()).has_value(); }

/// The frames among a folder's images; see open_cameras().
Files choose(const fs::path& folder, const Files& images, const std::string& pattern) {
  if (images.empty()) throw image_error(folder, "holds no PNG or TIFF image", "check replay.path", ExitCode::no_input);
  if (!pattern.empty()) {
    Files chosen =
        those(images, [&](const std::string& name) { return fnmatch(pattern.c_str(), name.c_str(), 0) == 0; });
    if (!chosen.empty()) return chosen;
    throw image_error(folder,
                      "none of its " + std::to_string(images.size()) + " images (" +
                          images.front().filename().string() + ", ...) matches replay.pattern '" + pattern + "'",
                      "correct the pattern, or leave it empty", ExitCode::no_input);
  }
  Files chosen = those(images, [](const std::string& name) { return starts_with_any(name, {"frame_"}); });
  if (chosen.empty()) chosen = those(images, is_camera_file);
  if (chosen.empty())
    chosen = those(images, [](const std::string& name) {
      return !starts_with_any(name, {"dark", "white", "background"});
    });
  if (chosen.empty())
    throw image_error(folder, "holds only dark, white or background images", "name its frames with replay.pattern",
                      ExitCode::no_input);
  return chosen;
}

std::vector<ImageSequence> from_sub_folders(const Listing& listing, const std::string& pattern) {
  std::vector<ImageSequence> cameras;
  for (const auto& [number, folder] : listing.cameras)
    cameras.emplace_back(folder.filename().string(), choose(folder, list(folder).images, pattern));
  return cameras;
}

std::vector<ImageSequence> from_files(const fs::path& folder, const Listing& listing, const std::string& pattern) {
  const Files frames = choose(folder, listing.images, pattern);
  if (!std::all_of(frames.begin(), frames.end(),
                   [](const fs::path& file) { return is_camera_file(file.filename()); })) {
    std::vector<ImageSequence> one;
    one.emplace_back("cam0", frames);
    return one;
  }
  std::map<std::uint64_t, Files> by_camera;
  for (const fs::path& file : frames) by_camera[*camera_number(file.stem().string())].push_back(file);
  std::vector<ImageSequence> cameras;
  for (auto& [number, files] : by_camera) cameras.emplace_back("cam" + std::to_string(number), std::move(files));
  return cameras;
}

}  // namespace

std::vector<ImageSequence> open_cameras(const fs::path& path, const std::string& pattern) {
  std::vector<ImageSequence> cameras;
  std::error_code code;
  if (path.empty())
    throw Error(ExitCode::configuration, "replay.path is empty; give a folder of images or a multi-page TIFF");
  if (!fs::is_directory(path, code)) {
    cameras.emplace_back("cam0", Files{path});
    return cameras;
  }
  const Listing listing = list(path);
  cameras = listing.cameras.empty() ? from_files(path, listing, pattern) : from_sub_folders(listing, pattern);
  if (cameras.size() > kMaxCameras)
    throw image_error(path, "holds " + std::to_string(cameras.size()) + " cameras",
                      "at most " + std::to_string(kMaxCameras) + " are supported: leave some out with replay.pattern",
                      ExitCode::configuration);
  if (!std::all_of(cameras.begin(), cameras.end(), [](const ImageSequence& camera) { return camera.numbered(); }))
    for (ImageSequence& camera : cameras) camera.number_by_position();
  return cameras;
}

}  // namespace rptv
