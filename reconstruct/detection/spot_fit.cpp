// SPDX-License-Identifier: MIT
// The arithmetic of sub-pixel centres, compiled once per instruction set.
#include "reconstruct/detection/spot_fit.hpp"

#include <cstring>

#include "reconstruct/detection/spot_centre_kernel.hpp"
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
      each_pixel(
          options, [&](std::size_t k, float, float) __attribute__((always_inline)) {
            for (std::size_t i = 0; i < kLanes; ++i)
              greys[k][i] = batch.grey[first + i][k], usables[k][i] = batch.usable[first + i][k];
          });
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

  RPTV_LANES static void find_all(const SpotBatch& batch, const SpotOptions& options, SpotCentres& centres) noexcept {
    for (std::size_t first = 0; first < SpotBatch::kSpots; first += kLanes) find(batch, first, options, centres);
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
