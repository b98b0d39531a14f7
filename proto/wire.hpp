// SPDX-License-Identifier: MIT
// The published messages as plain structs: what a subscriber gets out of the bytes.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/clock.hpp"
#include "core/latency.hpp"
#include "proto/status.hpp"

namespace rptv {

inline constexpr std::uint32_t kWireSchema = 1;

/// Topics of the live stream, first part of each message.
enum class Topic : std::uint8_t { tracks, particles, status, rig, count_ };
inline constexpr std::size_t kTopicCount = static_cast<std::size_t>(Topic::count_);

constexpr std::string_view name_of(Topic topic) noexcept {
  constexpr std::array<std::string_view, kTopicCount> kNames{"tracks", "particles", "status", "rig"};
  return kNames[static_cast<std::size_t>(topic)];
}

/// Columns of equal length; units mm and mm/s.
struct TracksColumns {
  std::vector<std::uint64_t> id;
  std::vector<float> x_mm, y_mm, z_mm, vx_mm_s, vy_mm_s, vz_mm_s, residual_mm;
  std::vector<std::uint32_t> age_frames;
  std::vector<std::array<float, 3>> acceleration_mm_s2;  ///< this and the covariances: empty without a Kalman filter
  std::vector<std::array<float, 6>> position_covariance_mm2, velocity_covariance_mm2_s2, acceleration_covariance_mm2_s4;
  std::uint32_t adapted_subnets = 0, cut_subnets = 0;
  bool operator==(const TracksColumns&) const = default;
};

/// Columns of equal length; units mm and mm².
struct ParticlesColumns {
  std::vector<float> x_mm, y_mm, z_mm, residual_mm, support;
  std::vector<float> ghost;                          ///< probability that it is none; empty from senders without it
  std::vector<std::array<float, 6>> covariance_mm2;  ///< xx, xy, xz, yy, yz, zz
  bool operator==(const ParticlesColumns&) const = default;
};

struct RigTexts {
  std::string calibration;
  std::string config;
};

/// One message. `frame` to `deaths` are set with tracks and particles only.
struct WireMessage {
  std::uint32_t schema = 0;
  std::string session;
  std::string boot_id;
  std::uint64_t sequence = 0;
  std::uint64_t frame = 0;
  std::int64_t exposure_end_ns = 0;
  ClockId clock = ClockId::nominal;
  Stamps stamps;
  std::vector<std::uint64_t> births, deaths;
  std::variant<TracksColumns, ParticlesColumns, StatusReport, RigTexts> content;
};

}  // namespace rptv
