// SPDX-License-Identifier: MIT
// Exposure by the histogram; then the finder for the board's kind.
#include "calibration/cameras/board_image.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "calibration/cameras/charuco.hpp"
#include "core/error.hpp"

namespace rptv {

namespace {
constexpr double kMostSaturated = 0.2;  // of the pixels brighter than half the top
constexpr float kLeastContrast = 0.15F,
                kLeastGreys = 10;  // between the darkest and brightest thousandth; of the latter
}  // namespace

void check_board_image(const ImageView& image, std::uint32_t significant_bits, const std::string& origin) {
  const auto refuse = [&](const std::string& text) { throw Error(ExitCode::bad_data, origin + ": " + text); };
  const auto top = static_cast<float>((std::uint64_t{1} << significant_bits) - 1);
  GreyImage grey(image);
  std::vector<float>& values = grey.grey;
  const auto bright = std::count_if(values.begin(), values.end(), [&](float v) { return v > 0.5F * top; });
  const auto full = std::count_if(values.begin(), values.end(), [&](float v) { return v >= top; });
  if (full > 0 && static_cast<double>(full) > kMostSaturated * static_cast<double>(bright))
    refuse(
        fmt::format("is saturated: {:.0f} % of its bright pixels are at {:.0f}, the highest of {} bits; shorten the "
                    "exposure until the white squares are at two thirds of it",
                    100 * static_cast<double>(full) / static_cast<double>(bright), top, significant_bits));
  const auto at = [&](double share) {
    const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), place, values.end());
    return *place;
  };
  const float low = at(0.001), high = at(0.999);
  if (high - low < std::max(kLeastGreys, kLeastContrast * high))
    refuse(
        fmt::format("is empty: its grey values lie between {:.0f} and {:.0f} of {:.0f}; light the target, and leave "
                    "out images without it",
                    low, high, top));
}

std::vector<SeenPoint> find_board(const ImageView& image, const Board& board) {
  const GreyImage grey(image);
  return board.kind == "dots" ? find_dots(grey, board) : find_charuco(grey, board);
}

std::vector<SeenPoint> read_seen_points(const std::filesystem::path& file, const Board& board) {
  const NumberedPoints numbered = read_numbered_points(file, 2);
  std::vector<SeenPoint> seen;
  for (std::size_t i = 0; i < numbered.ids.size(); ++i) {
    const auto at = std::find(board.ids.begin(), board.ids.end(), numbered.ids[i]);
    if (at == board.ids.end())
      throw Error(ExitCode::bad_data, fmt::format("{}: id {} is not one of the target's {} points; number them alike",
                                                  file.string(), numbered.ids[i], board.ids.size()));
    seen.push_back({static_cast<std::size_t>(at - board.ids.begin()), {numbered.values[i][0], numbered.values[i][1]}});
  }
  std::sort(seen.begin(), seen.end(), [](const SeenPoint& a, const SeenPoint& b) { return a.point < b.point; });
  return seen;
}

}  // namespace rptv
