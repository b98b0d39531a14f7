// SPDX-License-Identifier: MIT
// Waves in directions that a spiral spreads over the sphere, polarised across them.
#include "simulation/wave_flow.hpp"

#include <cmath>
#include <numbers>

#include "simulation/random.hpp"

namespace rptv {

namespace {
constexpr std::uint64_t kWaveStream = std::uint64_t{6} << 56;
constexpr double kTurn = 2 * std::numbers::pi;

Vector3 scaled(double factor, const Vector3& v) noexcept { return {factor * v.x, factor * v.y, factor * v.z}; }
Vector3 cross(const Vector3& a, const Vector3& b) noexcept {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
double length(const Vector3& v) noexcept { return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z); }
}  // namespace

WaveFlow::WaveFlow(const WavesSettings& waves, const FlowSettings& flow, std::uint64_t seed)
    : drift_{flow.drift_x_mm_s, 0, flow.drift_z_mm_s} {
  Random random(seed, kWaveStream);
  // a coordinate of the sum has the variance of kWaves·|a|²/6: a third of each wave's, half of a sine's
  const double amplitude = waves.rms_mm * std::sqrt(6.0 / kWaves);
  for (std::size_t i = 0; i < kWaves; ++i) {
    const double height = 1 - (2 * static_cast<double>(i) + 1) / kWaves, across = std::sqrt(1 - height * height);
    const double longitude = kTurn * 0.381966 * static_cast<double>(i);
    const Vector3 along{across * std::cos(longitude), across * std::sin(longitude), height};
    const Vector3 any = cross(along, {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
    const double omega = kTurn * waves.rate_hz * random.uniform(0.5, 1.5) * (i % 2 == 0 ? 1 : -1);
    waves_[i] = {scaled(amplitude / length(any), any),
                 scaled(kTurn / waves.length_mm * random.uniform(0.7, 1.3), along), omega, random.uniform(0, kTurn)};
  }
}

Vector3 WaveFlow::position(const Vector3& rest, double time_s) const noexcept {
  Vector3 at{rest.x + drift_.x * time_s, rest.y + drift_.y * time_s, rest.z + drift_.z * time_s};
  for (const Wave& wave : waves_) {
    const double swing = std::sin(wave.angle(rest, time_s));
    at.x += wave.amplitude.x * swing, at.y += wave.amplitude.y * swing, at.z += wave.amplitude.z * swing;
  }
  return at;
}

Vector3 WaveFlow::velocity(const Vector3& rest, double time_s) const noexcept {
  Vector3 v = drift_;
  for (const Wave& wave : waves_) {
    const double rate = wave.omega_rad_s * std::cos(wave.angle(rest, time_s));
    v.x += wave.amplitude.x * rate, v.y += wave.amplitude.y * rate, v.z += wave.amplitude.z * rate;
  }
  return v;
}

double WaveFlow::fastest_mm_s() const noexcept {
  double fastest = length(drift_);
  for (const Wave& wave : waves_) fastest += length(wave.amplitude) * std::abs(wave.omega_rad_s);
  return fastest;
}

}  // namespace rptv
