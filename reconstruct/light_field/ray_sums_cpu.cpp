// SPDX-License-Identifier: MIT
// Written once, compiled for AVX-512, AVX2 and any processor.
#include <array>

#include "core/instruction_set.hpp"
#include "reconstruct/light_field/ray_sums.hpp"

namespace rptv {

namespace {

constexpr std::size_t kLanes = 8;
static_assert(kLanes <= RayColumns::kPadding);
using Lanes = std::array<float, kLanes>;

// In double: a frame's sums must not depend on how many rays there are.
double total(const Lanes& lanes) noexcept {
  double sum = 0;
  for (const float lane : lanes) sum += static_cast<double>(lane);
  return sum;
}

[[gnu::always_inline]] inline RaySums sum_rays_here(const RayColumns& rays, const RayGate& gate, const ImagePoint& at,
                                                    double half_width_mm) noexcept {
  const float x = static_cast<float>(at.x), y = static_cast<float>(at.y), z = static_cast<float>(at.z);
  const float cosine = static_cast<float>(gate.cosine), sine = static_cast<float>(gate.sine);
  const float half = static_cast<float>(half_width_mm);
  Lanes w{}, ws_x{}, ws_y{}, wss{}, wr_x{}, wr_y{}, wrs{}, wrr{};
  for (std::size_t first = 0; first < rays.size; first += kLanes) {
    const float *c_x = rays.centre_x.data() + first, *c_y = rays.centre_y.data() + first;
    const float *s_x = rays.slope_x.data() + first, *s_y = rays.slope_y.data() + first;
    const auto left = static_cast<float>(rays.size - first);
    for (std::size_t k = 0; k < kLanes; ++k) {
      const float r_x = c_x[k] + s_x[k] * z - x, r_y = c_y[k] + s_y[k] * z - y;
      const float along = std::abs(cosine * r_x + sine * r_y), across = std::abs(cosine * r_y - sine * r_x);
      const float inside = along <= half ? 1.0F : 0.0F, beside = across <= half ? 1.0F : 0.0F;
      const float real = static_cast<float>(static_cast<int>(k)) < left ? 1.0F : 0.0F;
      const float weight = inside * beside * real;
      w[k] += weight;
      ws_x[k] += weight * s_x[k], ws_y[k] += weight * s_y[k];
      wss[k] += weight * (s_x[k] * s_x[k] + s_y[k] * s_y[k]);
      wr_x[k] += weight * r_x, wr_y[k] += weight * r_y;
      wrs[k] += weight * (r_x * s_x[k] + r_y * s_y[k]);
      wrr[k] += weight * (r_x * r_x + r_y * r_y);
    }
  }
  RaySums sums;
  sums.w = total(w), sums.ws_x = total(ws_x), sums.ws_y = total(ws_y), sums.wss = total(wss);
  sums.wr_x = total(wr_x), sums.wr_y = total(wr_y), sums.wrs = total(wrs), sums.wrr = total(wrr);
  return sums;
}

using SumRays = RaySums (*)(const RayColumns&, const RayGate&, const ImagePoint&, double) noexcept;

RaySums sum_rays_any(const RayColumns& rays, const RayGate& gate, const ImagePoint& at, double half) noexcept {
  return sum_rays_here(rays, gate, at, half);
}

#if defined(__x86_64__)
[[gnu::target("avx2")]] RaySums sum_rays_avx2(const RayColumns& rays, const RayGate& gate, const ImagePoint& at,
                                              double half) noexcept {
  return sum_rays_here(rays, gate, at, half);
}
// Eight lanes here too, for the same sums: it is the 32 registers that help.
[[gnu::target("avx512f,avx512bw,avx512vl,avx2")]] RaySums sum_rays_avx512(const RayColumns& rays, const RayGate& gate,
                                                                          const ImagePoint& at, double half) noexcept {
  return sum_rays_here(rays, gate, at, half);
}
#endif

SumRays best_sum_rays() noexcept {
#if defined(__x86_64__)
  if (best_instruction_set() == InstructionSet::avx512) return sum_rays_avx512;
  if (best_instruction_set() == InstructionSet::avx2) return sum_rays_avx2;
#endif
  return sum_rays_any;
}

const SumRays kSumRays = best_sum_rays();

}  // namespace

RaySums sum_rays(const RayColumns& rays, const RayGate& gate, const ImagePoint& at, double half_width_mm) noexcept {
  return kSumRays(rays, gate, at, half_width_mm);
}

}  // namespace rptv
