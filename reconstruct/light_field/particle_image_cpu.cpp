// SPDX-License-Identifier: MIT
// Written once, compiled for AVX2 and for any processor; no fused steps, so the results are the same.
#include "reconstruct/light_field/particle_image_cpu.hpp"

#include "core/instruction_set.hpp"

namespace rptv {

namespace {

template <bool kRims>
[[gnu::always_inline]] inline void light_row_with(const ParticleView& view, const LightRow& row) noexcept {
  float* __restrict value = row.value, * __restrict dx = row.dx, * __restrict dy = row.dy, * __restrict dz = row.dz;
  const ParticleView v = view;
  const float c_x = row.centre_x, c_y = row.centre_y, s_x = row.s_x, s_y = row.s_y, step = row.step;
  for (std::ptrdiff_t i = 0; i < row.count; ++i) {
    const ParticleLight light = light_at<kRims>(v, c_x, c_y, s_x - static_cast<float>(static_cast<int>(i)) * step, s_y);
    value[i] = light.value, dx[i] = light.dx, dy[i] = light.dy, dz[i] = light.dz;
  }
}

[[gnu::always_inline]] inline void light_row_here(const ParticleView& view, const LightRow& row) noexcept {
  view.has_rims ? light_row_with<true>(view, row) : light_row_with<false>(view, row);
}

[[gnu::always_inline]] inline void filter_line_here(const float* __restrict from, float* __restrict to,
                                                    std::ptrdiff_t count, std::ptrdiff_t step, const float* weights,
                                                    std::ptrdiff_t reach) noexcept {
  for (std::ptrdiff_t first = 0; first < count; first += kPixelBlock) {
    float sum[kPixelBlock];
    for (std::ptrdiff_t i = 0; i < kPixelBlock; ++i) sum[i] = weights[0] * from[first + i];
    for (std::ptrdiff_t k = 1; k <= reach; ++k) {
      const float weight = weights[k];
      const float *before = from + first - k * step, *behind = from + first + k * step;
      for (std::ptrdiff_t i = 0; i < kPixelBlock; ++i) sum[i] += weight * (before[i] + behind[i]);
    }
    for (std::ptrdiff_t i = 0; i < kPixelBlock; ++i) to[first + i] = sum[i];
  }
}

using LightRowFunction = void (*)(const ParticleView&, const LightRow&) noexcept;
using FilterFunction = void (*)(const float*, float*, std::ptrdiff_t, std::ptrdiff_t, const float*,
                                std::ptrdiff_t) noexcept;

struct Loops {
  LightRowFunction light_row;
  FilterFunction filter_line;
};

#define RPTV_LOOPS(name, ...)                                                                                  \
  __VA_ARGS__ void light_row_##name(const ParticleView& view, const LightRow& row) noexcept {                  \
    light_row_here(view, row);                                                                                 \
  }                                                                                                            \
  __VA_ARGS__ void filter_line_##name(const float* from, float* to, std::ptrdiff_t count, std::ptrdiff_t step, \
                                      const float* weights, std::ptrdiff_t reach) noexcept {                   \
    filter_line_here(from, to, count, step, weights, reach);                                                   \
  }

RPTV_LOOPS(any)
#if defined(__x86_64__)
RPTV_LOOPS(avx2, [[gnu::target("avx2")]])
#endif

Loops best_loops() noexcept {
#if defined(__x86_64__)
  if (best_instruction_set() != InstructionSet::portable) return {light_row_avx2, filter_line_avx2};
#endif
  return {light_row_any, filter_line_any};
}

const Loops kLoops = best_loops();

}  // namespace

void light_row(const ParticleView& view, const LightRow& row) noexcept { kLoops.light_row(view, row); }

void filter_line(const float* from, float* to, std::ptrdiff_t count, std::ptrdiff_t step, const float* weights,
                 std::ptrdiff_t reach) noexcept {
  kLoops.filter_line(from, to, count, step, weights, reach);
}

}  // namespace rptv
