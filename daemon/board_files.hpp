// SPDX-License-Identifier: MIT
// Which file holds which camera's image of which view, by their names; and what is seen in them.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "calibration/cameras/board.hpp"
#include "calibration/cameras/board_views.hpp"

namespace rptv {

struct BoardFile {
  std::string camera, view;
  std::filesystem::path file;
};

/// Files among `paths` (folders: the files in them and in their sub-folders) whose last path components match
/// `pattern`:
/// `{camera}` and `{view}` stand for any text, `*` for text that does not matter. A camera is called what its path
/// component has up to there: "cam{camera}_{view}.png" calls cam0_07.png's camera cam0 and its view 07. Sorted by
/// camera and view as people count. Throws Error: usage (a pattern without both), no_input (nothing matches), bad_data
/// (two files for one image, one camera only).
std::vector<BoardFile> find_board_files(const std::vector<std::string>& paths, const std::string& pattern);

/// Looks at every file. Text files hold points that were measured elsewhere, and need `sizes`: the images' width and
/// height (px). Throws Error, naming camera, view or file, for a view that a camera has no file of (unless
/// `allow_missing`), more cameras than a rig has, images of one camera of different sizes, damaged, saturated or empty
/// images, and when the target is in none. `looked` is called after each file.
BoardSet read_board_set(const std::vector<BoardFile>& files, const Board& board, const std::vector<int>& size_px,
                        bool allow_missing, const std::function<void()>& looked);

}  // namespace rptv
