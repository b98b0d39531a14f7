// SPDX-License-Identifier: MIT
// Spots that overlap: each fitted to what the others leave, and a search for those that hide in another's image.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "reconstruct/detection/crowded_square.hpp"
#include "reconstruct/detection/detector_settings.hpp"
#include "reconstruct/detection/fitted_spot.hpp"
#include "reconstruct/detection/grey_over_background.hpp"
#include "reconstruct/detection/model_image.hpp"
#include "reconstruct/detection/separate_spots.hpp"
#include "reconstruct/detection/spot_fit.hpp"
#include "reconstruct/detection/spot_neighbours.hpp"

namespace rptv {

/// Block by block least squares (Gauss and Seidel): in a sweep every crowded spot is fitted to the image without the
/// Gaussians of all others. Widths are drawn to the median of the frame. Then, where a spot leaves light that noise
/// does not explain, another one is put, and the sweeps go on. All memory is taken by the constructor. One thread.
class SpotOverlaps {
 public:
  SpotOverlaps(const DetectorSettings& settings, const ImageShape& shape, const SpotOptions& options,
               std::size_t most_spots, InstructionSet set);

  /// Improves crowded spots, appends new ones up to the capacity of `spots`, and removes what turned out to be none.
  /// Returns how many were left as they are because more than settings.max_overlapping are crowded, or because they see
  /// more of each other than there is room for; 0 otherwise.
  template <class Pixel>
  std::size_t untangle(const GreyOverBackground<Pixel>& grey, std::vector<FittedSpot>& spots) noexcept;

 private:
  static constexpr std::int32_t kSearchBeyond = 2;  // px around the square of a spot in which another may hide

  void expect_width(const std::vector<FittedSpot>& spots) noexcept;
  template <class Pixel>
  std::size_t sweep(const GreyOverBackground<Pixel>& grey, std::vector<FittedSpot>& spots) noexcept;
  template <class Pixel>
  bool fill(const GreyOverBackground<Pixel>& grey, std::vector<FittedSpot>& spots, std::uint32_t i) noexcept;
  void fit_batch(std::vector<FittedSpot>& spots) noexcept;
  template <class Pixel>
  std::size_t find_hidden(const GreyOverBackground<Pixel>& grey, std::vector<FittedSpot>& spots) noexcept;
  template <class Visit>
  void each_crowded_pair(std::vector<FittedSpot>& spots, double reach, const Visit& visit) noexcept;
  void remove_false(std::vector<FittedSpot>& spots) noexcept;
  void widen_errors(std::vector<FittedSpot>& spots) noexcept;

  const InstructionSet set_;
  const std::int64_t sweeps_;
  const bool find_hidden_;
  const std::size_t most_crowded_;
  const float split_sigmas_, faintest_;
  const GreyNoise noise_;
  SpotOptions options_;
  SpotNeighbours neighbours_;
  std::optional<ModelImage> model_;  // to find hidden ones: zero but while it looks for them
  float seen_px_ = 0;                // how far a spot's light reaches into another's square
  std::vector<float> bends_;
  std::vector<std::uint32_t> crowded_, pending_, deferred_;  // numbers of spots
  CrowdedSquare square_{};
  SpotBatch batch_{};
  SpotCentres centres_{};
  std::array<std::uint32_t, SpotBatch::kSpots> in_batch_{};
  std::size_t batch_size_ = 0;
};

}  // namespace rptv
