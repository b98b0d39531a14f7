// SPDX-License-Identifier: MIT
// Votes for a disparity: many wrong ones spread over the map, the true ones lie on one spot (Wieneke 2008).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "calibration/cameras/brown_distortion.hpp"

namespace rptv {

/// The spot of a map. A disparity is a particle's projection less its detection, column and row, px.
struct DisparityPeak {
  Pixel at_px{};
  double sigma_px = 0;  ///< standard error of each coordinate by the number of votes; where wrong ones outnumber the
                        ///< true by far, up to twice as much
  double votes = 0;     ///< of the spot, those of the surroundings taken off
};

/// A disc of cells round no disparity. Set-up takes all memory; add() and clear() are plain arithmetic without
/// allocation, peak() allocates. One thread at a time.
class DisparityMap {
 public:
  static constexpr int kCells = 49;  ///< across; the middle of the middle cell is no disparity
  /// Of a peak, votes over their standard error (Poisson's, of spot and surroundings): fewer could be chance.
  static constexpr double kSurest = 5;

  /// Disparities up to `radius_px` are votes. Throws Error(usage) unless it is positive.
  explicit DisparityMap(double radius_px);

  /// One vote, shared out over the four nearest cells so that its centre of mass stays. False, and counted in
  /// outside(), beyond the map; a disparity that is no number is outside, too.
  bool add(const Pixel& disparity_px) noexcept;
  void clear() noexcept;
  /// The map and the counts times `factor`, 0 to 1: older votes fade.
  void fade(double factor) noexcept;

  /// Where votes rise most surely above what the surroundings let expect, to a part of a cell; none where that may be
  /// chance.
  std::optional<DisparityPeak> peak() const;

  double radius_px() const noexcept { return radius_px_; }
  double cell_px() const noexcept { return 2 * radius_px_ / (kCells - 1); }
  double votes() const noexcept { return votes_; }
  double outside() const noexcept { return outside_; }

 private:
  double radius_px_;
  double votes_ = 0, outside_ = 0;
  std::vector<float> cells_;  ///< row by row
};

}  // namespace rptv
