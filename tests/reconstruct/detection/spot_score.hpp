// SPDX-License-Identifier: MIT
// What a detector found, compared with the spots that are there.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "reconstruct/detection/detections.hpp"
#include "tests/reconstruct/detection/painted_spots.hpp"

namespace rptv::testing {

/// Found against painted; pairs are one-to-one, nearest first, within `within_px`.
struct SpotScore {
  std::size_t painted = 0, found = 0, pairs = 0;
  double rms_px = 0;               ///< per axis, of the pairs
  double normalised_variance = 0;  ///< mean square of error over its standard error

  double recall() const { return static_cast<double>(pairs) / static_cast<double>(painted); }
  double precision() const { return static_cast<double>(pairs) / static_cast<double>(found); }
};

inline SpotScore score_spots(const Detections& found, const std::vector<PaintedSpot>& spots, double within_px) {
  struct Pair {
    double distance;
    std::size_t found, spot;
  };
  std::vector<Pair> pairs;
  for (std::size_t f = 0; f < found.size(); ++f)
    for (std::size_t s = 0; s < spots.size(); ++s)
      if (const double dx = found.x_px[f] - spots[s].x_px, dy = found.y_px[f] - spots[s].y_px;
          std::abs(dx) <= within_px && std::hypot(dx, dy) <= within_px)
        pairs.push_back({std::hypot(dx, dy), f, s});
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.distance < b.distance; });
  std::vector<char> found_used(found.size()), spot_used(spots.size());
  SpotScore score{spots.size(), found.size(), 0, 0, 0};
  for (const auto& [distance, f, s] : pairs) {
    if (found_used[f] != 0 || spot_used[s] != 0) continue;
    found_used[f] = spot_used[s] = 1;
    ++score.pairs;
    score.rms_px += distance * distance / 2;
    score.normalised_variance += distance * distance / (2 * found.sigma_px[f] * found.sigma_px[f]);
  }
  const auto n = static_cast<double>(std::max<std::size_t>(score.pairs, 1));
  score.rms_px = std::sqrt(score.rms_px / n), score.normalised_variance /= n;
  return score;
}

}  // namespace rptv::testing
