// SPDX-License-Identifier: MIT
// The arithmetic of sub-pixel centres, compiled once per instruction set.
#include "reconstruct/detection/spot_fit.hpp"

#include <cstring>

#include "reconstruct/detection/lanes.hpp"
#include "reconstruct/detection/log_gaussian.hpp"
#include "reconstruct/lit_mask.hpp"

namespace rptv {

namespace {

constexpr int kSteps = 2;  // of Gauss and Newton: a third changes nothing that noise does not hide

// For registers of so many numbers.
template <std::size_t kLanes>
struct SpotFit {
  using Lanes = typename LaneTypes<kLanes>::Lanes;
  using LaneBits = typename LaneTypes<kLanes>::Bits;

  RPTV_LANES static Lanes all_lanes(float value) noexcept { return Lanes{} + value; }

  struct Centre {
    Lanes x, y, variance;
    LaneBits bad;                                            // no peak within the square
    Lanes peak = Lanes{}, bend = Lanes{}, misfit = Lanes{};  // of a Gaussian
  };

  // The squares of a batch, a pixel of all spots side by side.
  struct Squares {
    RPTV_LANES Squares(const SpotBatch& batch, std::size_t first, const SpotOptions& of) noexcept : options(of) {
      each([&](std::size_t k, float, float) __attribute__((always_inline)) {
        for (std::size_t i = 0; i < kLanes; ++i)
          grey[k][i] = batch.grey[first + i][k], usable[k][i] = batch.usable[first + i][k];
      });
    }
    RPTV_LANES Lanes noise(Lanes light) const noexcept {
      return most(light, Lanes{}) * options.grey_per_electron + options.noise_variance;
    }
    // visit(k, dx, dy) for every pixel
    template <class Visit>
    RPTV_LANES void each(const Visit& visit) const noexcept {
      const int radius = static_cast<int>(options.radius);
      for (int dy = -radius; dy <= radius; ++dy) {
        std::size_t k = static_cast<std::size_t>(dy + radius) * SpotBatch::kRow;
        for (int dx = -radius; dx <= radius; ++dx) visit(k++, static_cast<float>(dx), static_cast<float>(dy));
      }
    }

    const SpotOptions& options;
    std::array<Lanes, SpotBatch::kPixels> grey, usable;
  };

  // A start that is no peak is made a wide one, for the steps to try.
  RPTV_LANES static void bound(LogGaussian<Lanes>& fit) noexcept {
    fit.q = least(most(fit.q, all_lanes(-3)), all_lanes(-0.02F));  // σ from 0.4 to 5 px
  }

  // A Gaussian is the product of two: one along the columns of the square and one along its rows.
  struct Profile {
    RPTV_LANES Profile(std::size_t radius, Lanes slope, Lanes bend, Lanes middle) noexcept {
      for (std::size_t i = 0; i <= 2 * radius; ++i) {
        const float at = static_cast<float>(i) - static_cast<float>(radius);
        logarithm[i] = middle + slope * at + bend * (at * at);
        value[i] = exp_of(logarithm[i]);
      }
    }
    std::array<Lanes, 2 * SpotBatch::kMostRadius + 1> logarithm, value;
  };

  RPTV_LANES static Centre gaussian(const Squares& square) noexcept {
    NormalEquations<Lanes> start;
    square.each([&](std::size_t k, float dx, float dy) __attribute__((always_inline)) {
      const Lanes grey = square.grey[k], usable = square.usable[k];
      const Lanes bright = most(grey, all_lanes(1e-3F));
      const Lanes weight = grey > 0.0F ? usable * bright * bright / square.noise(grey) : Lanes{};
      start.add(dx, dy, weight, weight * log_of(bright));
    });
    LogGaussian<Lanes> fit = start.solve();
    NormalEquations<Lanes> equations;
    Lanes left{};  // squares of what the model leaves, over their variance
    for (int step = 0; step < kSteps; ++step) {
      bound(fit);
      equations = NormalEquations<Lanes>();
      equations.rr = all_lanes(square.options.bend_weight);
      equations.tr = equations.rr * square.options.expected_bend;
      left = Lanes{};
      const Profile columns(square.options.radius, fit.b, fit.q, Lanes{}),
          rows(square.options.radius, fit.c, fit.q, fit.a);
      square.each([&](std::size_t k, float dx, float dy) __attribute__((always_inline)) {
        const std::size_t column = k % SpotBatch::kRow, row = k / SpotBatch::kRow;
        const Lanes logarithm = columns.logarithm[column] + rows.logarithm[row];
        const Lanes model = columns.value[column] * rows.value[row], off = square.grey[k] - model;
        const Lanes per_noise = square.usable[k] / square.noise(model);
        const Lanes weight = per_noise * model;
        equations.add(dx, dy, weight * model, weight * (model * logarithm + off));
        left += per_noise * off * off;
      });
      fit = equations.solve();
    }
    const Lanes x = fit.b / fit.q * -0.5F, y = fit.c / fit.q * -0.5F;
    const auto reach = static_cast<float>(square.options.radius);
    const Lanes variance = equations.variance(fit, x, y);
    const LaneBits good = (x * x < reach * reach) & (y * y < reach * reach) & (fit.q < -0.02F) & (variance > 0.0F) &
                          (variance < 1.0F);  // a pixel off tells nothing
    const Lanes peak = exp_of(fit.a + (fit.b * x + fit.c * y) * 0.5F);
    Lanes usable{};
    square.each([&](std::size_t k, float, float) __attribute__((always_inline)) { usable += square.usable[k]; });
    return {x, y, variance, ~good, peak, fit.q, left / most(usable - 4.0F, all_lanes(1))};
  }

  struct Parabola {
    Lanes at, variance;
    LaneBits good;
  };

  RPTV_LANES static Parabola parabola(const Squares& square, std::size_t before, std::size_t middle,
                                      std::size_t after) noexcept {
    const auto floor = [](Lanes grey) __attribute__((always_inline)) { return most(grey, all_lanes(1e-3F)); };
    const Lanes i0 = floor(square.grey[before]), i1 = floor(square.grey[middle]), i2 = floor(square.grey[after]);
    const Lanes usable = square.usable[before] * square.usable[middle] * square.usable[after];
    const Lanes l0 = log_of(i0), l1 = log_of(i1), l2 = log_of(i2), bend = l0 - l1 * 2.0F + l2;
    const Lanes at = (l0 - l2) / (bend * 2.0F);
    const Lanes g0 = 1.0F - at * 2.0F, g1 = at * 4.0F, g2 = 1.0F + at * 2.0F;
    const Lanes variance = (g0 * g0 * square.noise(i0) / (i0 * i0) + g1 * g1 * square.noise(i1) / (i1 * i1) +
                            g2 * g2 * square.noise(i2) / (i2 * i2)) /
                           (bend * bend * 4.0F);
    const LaneBits good =
        (usable > 0.0F) & (bend < 0.0F) & (i0 > 2e-3F) & (i2 > 2e-3F) & (at * at < 1.0F) & (variance < 1.0F);
    return {at, variance, good};
  }

  RPTV_LANES static Centre three_point(const Squares& square) noexcept {
    const std::size_t side = SpotBatch::kRow, middle = square.options.radius * (side + 1);
    const Parabola along_x = parabola(square, middle - 1, middle, middle + 1);
    const Parabola along_y = parabola(square, middle - side, middle, middle + side);
    return Centre{along_x.at, along_y.at, (along_x.variance + along_y.variance) * 0.5F, ~(along_x.good & along_y.good)};
  }

  struct Light {
    Centre centre;
    Lanes sum;
  };

  // Light of the columns (or rows) at both edges of the square and of those beside them, inwards.
  struct Edges {
    Lanes outer{}, inner{};

    RPTV_LANES void add(float offset, float radius, Lanes grey) noexcept {
      if (offset * offset == radius * radius) outer += grey;
      if (offset * offset == (radius - 1) * (radius - 1)) inner += radius == 1 ? grey + grey : grey;  // of both sides
    }
    // What of a shift of the spot its centre of light follows: light leaves the square over one edge and comes in over
    // the other, half a pixel beyond the outer columns, where light falls off as from the inner to the outer ones.
    RPTV_LANES Lanes follows(float radius, Lanes sum) const noexcept {
      const Lanes floor = sum * 1e-4F, far = most(outer, floor), near = most(inner, far);
      const float beyond = (radius + 0.25F) / (2 * radius - 1);  // by how much more the square of the distance grows
      const Lanes at_edge = exp_of(log_of(far) * (1 + beyond) - log_of(near) * beyond);
      return most(1.0F - at_edge * ((radius + 0.5F) / sum), all_lanes(0.1F));
    }
  };

  RPTV_LANES static Light centroid(const Squares& square) noexcept {
    const auto radius = static_cast<float>(square.options.radius);
    Lanes sum{}, sum_x{}, sum_y{}, spread_x{}, spread_y{};
    Edges columns, rows;
    square.each([&](std::size_t k, float dx, float dy) __attribute__((always_inline)) {
      const Lanes grey = square.grey[k];
      sum += grey, sum_x += grey * dx, sum_y += grey * dy;
      columns.add(dx, radius, grey), rows.add(dy, radius, grey);
    });
    const Lanes safe = most(sum, all_lanes(1e-3F)), x = sum_x / safe, y = sum_y / safe;
    square.each([&](std::size_t k, float dx, float dy) __attribute__((always_inline)) {
      const Lanes noise = square.noise(square.grey[k]);
      spread_x += (x - dx) * (x - dx) * noise, spread_y += (y - dy) * (y - dy) * noise;
    });
    const Lanes per_x = 1.0F / columns.follows(radius, safe), per_y = 1.0F / rows.follows(radius, safe);
    const auto clamped = [&](Lanes at) __attribute__((always_inline)) {
      return least(most(at, all_lanes(-radius)), all_lanes(radius));
    };
    const Lanes variance = (spread_x * per_x * per_x + spread_y * per_y * per_y) / (safe * safe) * 0.5F;
    return {Centre{clamped(x * per_x), clamped(y * per_y), variance, LaneBits{}}, sum};
  }

  RPTV_LANES static void replace_bad(Centre& centre, const Centre& by) noexcept {
    centre.x = centre.bad ? by.x : centre.x;
    centre.y = centre.bad ? by.y : centre.y;
    centre.variance = centre.bad ? by.variance : centre.variance;
    centre.peak = centre.bad ? by.peak : centre.peak;
    centre.bend = centre.bad ? by.bend : centre.bend;
    centre.misfit = centre.bad ? by.misfit : centre.misfit;
    centre.bad &= by.bad;
  }

  // Spots first … first + kLanes - 1 of the batch.
  RPTV_LANES static void find(const SpotBatch& batch, std::size_t first, const SpotOptions& options,
                              SpotCentres& centres) noexcept {
    const Squares square(batch, first, options);
    const Light light = centroid(square);
    Centre centre = options.method == SpotMethod::three_point ? three_point(square)
                    : options.method == SpotMethod::gaussian  ? gaussian(square)
                                                              : light.centre;
    if (options.method == SpotMethod::three_point && any(centre.bad)) replace_bad(centre, gaussian(square));
    if (any(centre.bad)) replace_bad(centre, light.centre);
    const auto store = [first](Lanes value, std::array<float, SpotBatch::kSpots> & to) __attribute__((always_inline)) {
      std::memcpy(to.data() + first, &value, sizeof value);
    };
    store(centre.x, centres.x), store(centre.y, centres.y);
    store(centre.variance, centres.variance), store(light.sum, centres.grey);
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
