// SPDX-License-Identifier: MIT
// Whether an image can show a target at all, and the points of the target in it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "calibration/cameras/board.hpp"
#include "calibration/cameras/board_views.hpp"
#include "core/image.hpp"

namespace rptv {

/// Throws Error(bad_data) for an image that is saturated (a fifth of its bright pixels at the top) or has no contrast.
void check_board_image(const ImageView& image, std::uint32_t significant_bits, const std::string& origin);

/// Points of a "charuco" or "dots" board; none when the image does not show it.
std::vector<SeenPoint> find_board(const ImageView& image, const Board& board);

/// Points of a "points" target that were measured elsewhere: text, `id column row` a line. Ids that the target does not
/// have are an Error(bad_data).
std::vector<SeenPoint> read_seen_points(const std::filesystem::path& file, const Board& board);

}  // namespace rptv
