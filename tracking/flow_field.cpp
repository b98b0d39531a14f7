// SPDX-License-Identifier: MIT
// Open addressing with a bounded number of probes.
#include "tracking/flow_field.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace rptv {

namespace {
constexpr std::size_t kNowhere = SIZE_MAX;
}

FlowField::FlowField(double bin_mm, std::size_t bins)
    : per_bin_(1 / bin_mm), bins_(std::bit_ceil(std::max<std::size_t>(bins, 2 * kProbes))) {}

/// 21 bits an axis, around 0; what is beyond shares the outermost cubes.
std::uint64_t FlowField::key_of(const VelocitySample& sample) const noexcept {
  const auto index = [&](double v) {
    return static_cast<std::uint64_t>(std::clamp(std::floor(v * per_bin_), -1'048'575.0, 1'048'575.0) + 1'048'576.0);
  };
  return index(sample.x_mm) | index(sample.y_mm) << 21 | index(sample.z_mm) << 42;
}

/// Of the cube, or of the first empty bin that it may have.
std::size_t FlowField::place_of(std::uint64_t key) const noexcept {
  const std::size_t mask = bins_.size() - 1;
  std::uint64_t h = key * 0x9E3779B97F4A7C15ULL;
  h = (h ^ (h >> 31)) * 0xBF58476D1CE4E5B9ULL;
  for (std::size_t probe = 0; probe < kProbes; ++probe) {
    const std::size_t place = ((h >> 20) + probe) & mask;
    if (bins_[place].key == key || bins_[place].key == 0) return place;
  }
  return kNowhere;
}

void FlowField::add(const VelocitySample& sample) noexcept {
  const std::uint64_t key = key_of(sample);
  const std::size_t place = place_of(key);
  if (place == kNowhere) return;
  Bin& bin = bins_[place];
  bin.key = key;
  bin.samples = std::min(bin.samples + 1, kMemory);
  const double weight = 1.0 / bin.samples;
  bin.vx_mm_s += weight * (sample.vx_mm_s - bin.vx_mm_s);
  bin.vy_mm_s += weight * (sample.vy_mm_s - bin.vy_mm_s);
  bin.vz_mm_s += weight * (sample.vz_mm_s - bin.vz_mm_s);
}

bool FlowField::look_up(VelocitySample& at) const noexcept {
  const std::uint64_t key = key_of(at);
  const std::size_t place = place_of(key);
  if (place == kNowhere || bins_[place].key != key || bins_[place].samples < kEnough) return false;
  at.vx_mm_s = bins_[place].vx_mm_s;
  at.vy_mm_s = bins_[place].vy_mm_s;
  at.vz_mm_s = bins_[place].vz_mm_s;
  return true;
}

}  // namespace rptv
