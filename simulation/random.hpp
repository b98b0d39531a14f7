// SPDX-License-Identifier: MIT
// Random numbers that depend on a seed and a stream only, so that any thread may render any frame.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

namespace rptv {

/// splitmix64: one step of a full-period mixer.
constexpr std::uint64_t mix_bits(std::uint64_t& state) noexcept {
  state += 0x9e3779b97f4a7c15U;
  std::uint64_t z = state;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
  return z ^ (z >> 31);
}

/// xoshiro256++ (Blackman and Vigna 2019). Streams of one seed are independent for practical purposes. One thread.
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t stream) noexcept {
    std::uint64_t key = seed;
    std::uint64_t state = mix_bits(key) ^ (stream * 0xd1342543de82ef95U);
    for (auto& word : state_) word = mix_bits(state);
  }
  std::uint64_t bits() noexcept {
    const std::uint64_t result = rotate(state_[0] + state_[3], 23) + state_[0];
    const std::uint64_t t = state_[1] << 17;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= t;
    state_[3] = rotate(state_[3], 45);
    return result;
  }
  /// Uniform in [0, 1).
  double uniform() noexcept { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }
  double uniform(double low, double high) noexcept { return low + (high - low) * uniform(); }
  /// Poisson deviate, exact: sequential search below 12, else transformed rejection (Hoermann 1993, PTRS).
  std::uint32_t poisson(double mean) noexcept;

 private:
  static std::uint64_t rotate(std::uint64_t value, int by) noexcept { return (value << by) | (value >> (64 - by)); }
  std::array<std::uint64_t, 4> state_{};
};

/// Normal deviates by table, four from one 64-bit number: the quantiles of 2^16 equal shares of the normal distribution
/// (so |value| < 4.4), exact in mean and scaled to unit variance. Set-up once, then read from any thread.
const float* normal_table();

}  // namespace rptv
