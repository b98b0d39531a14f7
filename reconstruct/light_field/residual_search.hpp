// SPDX-License-Identifier: MIT
// Where in what is left of an image a whole particle could be: a matched filter that others' light does not mislead.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/image.hpp"
#include "reconstruct/light_field/footprints.hpp"

namespace rptv {

/// A particle of the light that is looked for, where the grey values leave room for it.
struct ResidualHit {
  float score = 0;  ///< 1: all its light is there; 0: half of it is missing
  std::uint32_t footprint = 0, lenslet = 0;
};

/// Each pixel counts up to the light that the particle would give it, light that is more is somebody else's:
/// score = Σ w·g·(2·min(r, g) - g) / Σ w·g², for residuals r, expected grey values g and weights w. Nothing allocates
/// after construction.
class ResidualSearch {
 public:
  /// `footprints` and `lattice` must outlive this.
  ResidualSearch(const Footprints& footprints, const LensletLattice& lattice, ImageShape shape, std::size_t max_hits,
                 std::size_t threads);

  /// All with at least this score, best first; valid until the next call. `faint`: grey values of noise. The result
  /// does not depend on the number of threads.
  std::span<const ResidualHit> find(std::span<const float> residual, float least_score, float faint) noexcept;
  float score(std::span<const float> residual, const ResidualHit& hit) const noexcept;
  /// Takes the particle's light out of the residual.
  void subtract(std::span<float> residual, const ResidualHit& hit) const noexcept;
  std::uint64_t refused() const noexcept { return refused_; }  ///< hits beyond the room, in the last find()

 private:
  struct Found {
    std::vector<ResidualHit> hits;
    std::uint64_t refused = 0;
  };
  struct Place {
    const Footprints::Footprint& footprint;
    std::int32_t column, row;  // of the spot
    bool inside;               // all of the image on the sensor
  };
  void sum_light(std::span<const float> residual, float faint) noexcept;
  float light_in(const Place& place) const noexcept;
  Place place_of(std::uint32_t footprint, std::array<std::int32_t, 2> spot) const noexcept;
  float score_at(std::span<const float> residual, const Place& place, std::uint32_t first,
                 std::uint32_t last) const noexcept;
  void find_near(std::span<const float> residual, std::uint32_t lenslet, float least_score, Found& found) noexcept;

  const Footprints& footprints_;
  const LensletLattice& lattice_;
  const std::int32_t width_, height_;
  const std::size_t threads_;
  std::vector<double> light_;  // left of and above a pixel; with a column and a row of 0 before the first
  std::vector<Found> of_thread_;
  std::vector<ResidualHit> hits_;
  std::uint64_t refused_ = 0;
};

}  // namespace rptv
