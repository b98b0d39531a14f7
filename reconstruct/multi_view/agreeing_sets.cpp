// SPDX-License-Identifier: MIT
// Every set asks all others who is near, and the one with most neighbours has the place.
#include "reconstruct/multi_view/agreeing_sets.hpp"

#include <algorithm>
#include <cmath>

namespace rptv {
namespace {

constexpr double kNear = 1.0 / 6, kLeastNear_px = 0.4;  // of the radius
constexpr std::uint32_t kLeastNeighbours = 8;
constexpr double kSurely = 5;  // standard deviations of the number of neighbours by chance

bool near(const SetDisparities& a, const SetDisparities& b, float square_px2) {
  for (std::uint32_t common = a.views & b.views; common != 0; common &= common - 1) {
    const auto v = static_cast<std::size_t>(__builtin_ctz(common));
    const float x = a.px[v][0] - b.px[v][0], y = a.px[v][1] - b.px[v][1];
    if (x * x + y * y > square_px2) return false;
  }
  return true;
}

/// Mean disparities of the sets near `seed`.
SetDisparities mean_near(std::span<const SetDisparities> sets, const SetDisparities& seed, float square_px2) {
  SetDisparities mean;
  std::array<float, kMaxViews> count{};
  for (const SetDisparities& set : sets) {
    if (!near(set, seed, square_px2)) continue;
    for (std::size_t v = 0; v < kMaxViews; ++v) {
      if ((set.views >> v & 1U) == 0) continue;
      ++count[v];
      for (std::size_t k = 0; k < 2; ++k) mean.px[v][k] += set.px[v][k];
    }
  }
  for (std::size_t v = 0; v < kMaxViews; ++v) {
    if (count[v] == 0) continue;
    mean.views |= 1U << v;
    for (float& coordinate : mean.px[v]) coordinate /= count[v];
  }
  return mean;
}

}  // namespace

std::span<const SetDisparities> agreeing_sets(std::span<SetDisparities> sets, double radius_px) {
  const double near_px = std::max(kNear * radius_px, kLeastNear_px);
  const auto square_px2 = static_cast<float>(near_px * near_px);
  const auto tried = sets.first(std::min(sets.size(), kMostTried));
  std::vector<std::uint32_t> neighbours(tried.size());
  for (std::size_t a = 0; a < tried.size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      if (near(tried[a], tried[b], square_px2)) ++neighbours[a], ++neighbours[b];
  const auto most = std::max_element(neighbours.begin(), neighbours.end());
  if (most == neighbours.end() || *most < kLeastNeighbours) return {};
  const SetDisparities& seed = tried[static_cast<std::size_t>(most - neighbours.begin())];
  double others = 0, by_chance = 0;  // how many neighbours sets have that are not near the place
  for (std::size_t a = 0; a < tried.size(); ++a)
    if (!near(tried[a], seed, 9 * square_px2)) ++others, by_chance += neighbours[a];
  const double chance = others > 0 ? by_chance / others : 0;
  if (*most < chance + kSurely * std::sqrt(chance + 1)) return {};
  const SetDisparities place = mean_near(tried, seed, square_px2);
  const auto end =
      std::partition(sets.begin(), sets.end(), [&](const auto& set) { return near(set, place, 4 * square_px2); });
  return {sets.begin(), end};
}

}  // namespace rptv
