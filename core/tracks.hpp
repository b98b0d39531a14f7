// SPDX-License-Identifier: MIT
// The tracks that have a particle in one frame set, as a structure of arrays of fixed capacity.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/particles.hpp"

namespace rptv {

/// One track's state in one frame. Units mm, mm/s; frame of reference as the particles'.
struct TrackPoint {
  std::uint64_t particle = 0;  ///< identity, never reused within a session
  double x_mm = 0, y_mm = 0, z_mm = 0;
  double vx_mm_s = 0, vy_mm_s = 0, vz_mm_s = 0;  ///< 0 in a track's first frame
  double residual_mm = 0;
  std::uint32_t age_frames = 0;  ///< frames in which it was seen before this one
};

/// What a Kalman filter knows besides. Units mm/s², mm², mm²/s², mm²/s⁴.
struct TrackEstimate {
  double ax_mm_s2 = 0, ay_mm_s2 = 0, az_mm_s2 = 0;
  Covariance position_mm2{}, velocity_mm2_s2{}, acceleration_mm2_s4{};
  bool operator==(const TrackEstimate&) const = default;
};

/// Arrays of equal length size(), plus the identities born and ended in this frame. All memory is taken by the
/// constructor; push() never allocates. One thread at a time.
class Tracks {
 public:
  explicit Tracks(std::size_t capacity = 0) : capacity_(capacity) {
    for (auto* ids : {&particle, &births, &deaths}) ids->reserve(capacity);
    for (auto* column : {&x_mm, &y_mm, &z_mm, &vx_mm_s, &vy_mm_s, &vz_mm_s, &residual_mm}) column->reserve(capacity);
    age_frames.reserve(capacity);
    estimate.reserve(capacity);
  }
  std::size_t size() const noexcept { return particle.size(); }
  std::size_t capacity() const noexcept { return capacity_; }
  std::uint64_t overflow() const noexcept { return overflow_; }  ///< points or deaths refused since clear()

  void clear() noexcept {
    clear_events();
    particle.clear();
    for (auto* column : {&x_mm, &y_mm, &z_mm, &vx_mm_s, &vy_mm_s, &vz_mm_s, &residual_mm}) column->clear();
    age_frames.clear();
    estimate.clear();
  }
  /// All but the rows, for who gives every row a new value: what clear() and resize() would write once more.
  void clear_events() noexcept {
    births.clear();
    deaths.clear();
    overflow_ = 0;
    adapted_subnets = cut_subnets = 0;
  }
  /// False, and counted, when full. A point of age 0 is also listed in `births`.
  bool push(const TrackPoint& p) noexcept {
    if (size() == capacity_) {
      ++overflow_;
      return false;
    }
    particle.push_back(p.particle);
    x_mm.push_back(p.x_mm);
    y_mm.push_back(p.y_mm);
    z_mm.push_back(p.z_mm);
    vx_mm_s.push_back(p.vx_mm_s);
    vy_mm_s.push_back(p.vy_mm_s);
    vz_mm_s.push_back(p.vz_mm_s);
    residual_mm.push_back(p.residual_mm);
    age_frames.push_back(p.age_frames);
    if (p.age_frames == 0) births.push_back(p.particle);
    return true;
  }
  void push_death(std::uint64_t id) noexcept {
    if (deaths.size() == capacity_)
      ++overflow_;
    else
      deaths.push_back(id);
  }

  std::vector<std::uint64_t> particle;
  std::vector<double> x_mm, y_mm, z_mm, vx_mm_s, vy_mm_s, vz_mm_s, residual_mm;
  std::vector<std::uint32_t> age_frames;
  std::vector<std::uint64_t> births, deaths;
  std::vector<TrackEstimate> estimate;  ///< one per row where the linker filters, else empty; not by push()
  std::uint32_t adapted_subnets = 0;    ///< of this frame: solved at a reduced search range
  std::uint32_t cut_subnets = 0;        ///< of this frame: assigned approximately, for lack of time

 private:
  std::size_t capacity_ = 0;
  std::uint64_t overflow_ = 0;
};

}  // namespace rptv
