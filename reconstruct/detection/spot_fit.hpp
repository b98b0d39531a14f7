// SPDX-License-Identifier: MIT
// Sub-pixel centres of sixteen spots at a time, with their standard errors.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/instruction_set.hpp"

namespace rptv {

enum class SpotMethod : std::uint8_t { gaussian, three_point, centroid };

/// Squares of pixels round sixteen spots. Pixel (dx, dy) from the middle is at (dy + radius)·kRow + dx + radius.
struct alignas(64) SpotBatch {
  static constexpr std::size_t kSpots = 16, kMostRadius = 3, kRow = 8, kPixels = 7 * kRow;
  using Square = std::array<float, kPixels>;

  std::array<Square, kSpots> grey;        ///< over the background; 0 where `usable` is for a neighbour
  std::array<Square, kSpots> usable;      ///< weight: 1; 0: saturated, outside or a neighbour's
  std::array<bool, kSpots> all_usable{};  ///< hint: every weight of the square is 1
};

/// Where they are, in pixels from the middle of their squares.
struct alignas(64) SpotCentres {
  std::array<float, SpotBatch::kSpots> x, y;
  std::array<float, SpotBatch::kSpots> variance;  ///< of x and of y, their mean, px²
  std::array<float, SpotBatch::kSpots> grey;      ///< sum over the square
  // of the Gaussian; where there is none, bend is 0
  std::array<float, SpotBatch::kSpots> peak;    ///< its highest value
  std::array<float, SpotBatch::kSpots> bend;    ///< -1/2σ², px⁻²
  std::array<float, SpotBatch::kSpots> misfit;  ///< reduced χ²: 1 when noise is all that it leaves
};

struct SpotOptions {
  SpotMethod method = SpotMethod::gaussian;
  std::size_t radius = 2;    ///< 1 to kMostRadius
  float noise_variance = 1;  ///< of a dark pixel, grey²
  float grey_per_electron = 0.25F;
  float expected_bend = 0, bend_weight = 0;  ///< what is known of bend beforehand; weight: one over its variance
};

/// `gaussian`: least squares of A·exp(-((x-x₀)² + (y-y₀)²)/2σ²) with each pixel's weight by its noise: a fit to the
/// logarithms (Caruana, Searle, Heller, Shupack 1986) with the weights of Guo 2011, then two Gauss-Newton steps. The
/// errors are those of the normal equations. `three_point`: the peak of the parabola through the logarithms of three
/// pixels a side; where it has none, `gaussian`. `centroid`: centre of light; also where a Gaussian has no peak in the
/// square. Same bits with every instruction set. Any thread.
void find_spot_centres(const SpotBatch& batch, const SpotOptions& options, SpotCentres& centres,
                       InstructionSet set = best_instruction_set()) noexcept;

}  // namespace rptv
