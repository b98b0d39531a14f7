// SPDX-License-Identifier: MIT
// The arithmetic of sub-pixel centres, compiled once per instruction set.
#include "reconstruct/detection/spot_fit.hpp"

#include <algorithm>
#include <cstring>

#include "reconstruct/detection/spot_centre_kernel.hpp"
#include "reconstruct/detection/square_lanes.hpp"
#include "reconstruct/lit_mask.hpp"

namespace rptv {

namespace {

// For registers of so many numbers.
template <std::size_t kLanes>
struct SpotFit {
  using Lanes = typename LaneTypes<kLanes>::Lanes;

  // The squares of a batch, a pixel of all spots side by side.
  struct Squares {
    using Value = Lanes;

    RPTV_LANES Squares(const SpotBatch& batch, std::size_t first, const SpotOptions& of) noexcept : options(of) {
      const std::size_t rows = 2 * options.radius + 1;
      SquareLanes<kLanes>::turn(&batch.grey[first], rows, greys);
      const bool* hints = batch.all_usable.data() + first;
      if (std::all_of(hints, hints + kLanes, [](bool all) { return all; }))
        std::fill_n(usables.begin(), rows * SpotBatch::kRow, Lanes{} + 1.0F);
      else
        SquareLanes<kLanes>::turn(&batch.usable[first], rows, usables);
    }
    RPTV_LANES Lanes grey(std::size_t k) const noexcept { return greys[k]; }
    RPTV_LANES Lanes usable(std::size_t k) const noexcept { return usables[k]; }

    struct Profile {
      RPTV_LANES Profile(std::size_t radius, Lanes slope, Lanes bend, Lanes middle) noexcept {
        for (std::size_t i = 0; i <= 2 * radius; ++i) {
          const float at = static_cast<float>(i) - static_cast<float>(radius);
          logarithms[i] = middle + slope * at + bend * (at * at);
          values[i] = exp_of(logarithms[i]);
        }
      }
      RPTV_LANES Lanes logarithm(std::size_t i) const noexcept { return logarithms[i]; }
      RPTV_LANES Lanes value(std::size_t i) const noexcept { return values[i]; }
      std::array<Lanes, 2 * SpotBatch::kMostRadius + 1> logarithms, values;
    };

    const SpotOptions& options;
    std::array<Lanes, SpotBatch::kPixels> greys, usables;
  };

  // Spots first … first + kLanes - 1 of the batch.
  RPTV_LANES static void find(const SpotBatch& batch, std::size_t first, const SpotOptions& options,
                              SpotCentres& centres) noexcept {
    Lanes light;
    const SpotCentre<Lanes> centre = find_centre(Squares(batch, first, options), light);
    const auto store = [first](Lanes value, std::array<float, SpotBatch::kSpots> & to) __attribute__((always_inline)) {
      std::memcpy(to.data() + first, &value, sizeof value);
    };
    store(centre.x, centres.x), store(centre.y, centres.y);
    store(centre.variance, centres.variance), store(light, centres.grey);
    store(centre.peak, centres.peak), store(centre.bend, centres.bend), store(centre.misfit, centres.misfit);
  }

  // A radius that the compiler knows leaves no loop over pixels and columns.
  template <std::size_t kRadius>
  RPTV_LANES static void find_known(const SpotBatch& batch, SpotOptions options, SpotCentres& centres) noexcept {
    options.radius = kRadius;
    for (std::size_t first = 0; first < SpotBatch::kSpots; first += kLanes) find(batch, first, options, centres);
  }
  RPTV_LANES static void find_all(const SpotBatch& batch, const SpotOptions& options, SpotCentres& centres) noexcept {
    if (options.radius == 1) return find_known<1>(batch, options, centres);
    if (options.radius == 2) return find_known<2>(batch, options, centres);
    find_known<SpotBatch::kMostRadius>(batch, options, centres);
  }
};

void find_portable(const SpotBatch& batch, const SpotOptions& options, SpotCentres& centres) noexcept {
  SpotFit<4>::find_all(batch, options, centres);
}
#if defined(__x86_64__)
RPTV_LIT_AVX2 void find_avx2(const SpotBatch& batch, const SpotOptions& options, SpotCentres& centres) noexcept {
  SpotFit<8>::find_all(batch, options, centres);
}
RPTV_LIT_AVX512 void find_avx512(const SpotBatch& batch, const SpotOptions& options, SpotCentres& centres) noexcept {
  SpotFit<16>::find_all(batch, options, centres);
}
#endif

}  // namespace

void find_spot_centres(const SpotBatch& batch, const SpotOptions& options, SpotCentres& centres,
                       InstructionSet set) noexcept {
#if defined(__x86_64__)
  if (set == InstructionSet::avx512) return find_avx512(batch, options, centres);
  if (set == InstructionSet::avx2) return find_avx2(batch, options, centres);
#endif
  static_cast<void>(set);
  find_portable(batch, options, centres);
}

}  // namespace rptv
