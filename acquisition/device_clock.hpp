// SPDX-License-Identifier: MIT
// Maps the clock of a device to CLOCK_MONOTONIC by an offset and a drift that follow the frames' arrivals.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "core/clock.hpp"

namespace rptv {

/// Arrival is exposure end plus a delay that is positive, mostly small and sometimes large. So the pairs (device,
/// arrival − device) lie above the line that is sought, and the lower convex hull of the last 64 quarter seconds' least
/// ones bounds it; the hull's edge over the middle of the window is the line (Zhang, Liu, Xia: Clock synchronization
/// algorithms for network measurements, INFOCOM 2002). The least delay itself cannot be told from an offset and stays
/// in.
///
/// map(): one thread, which allocates nothing and costs one pass over 64 points. mapping(): any thread.
class DeviceClock {
 public:
  /// Host time of an exposure, ns: never later than `arrival_ns` and never earlier than the one before, arrivals given
  /// in order. Times of the device that run backwards, lie in the future or stay behind for a second begin a new fit.
  std::int64_t map(std::int64_t device_ns, std::int64_t arrival_ns) noexcept;
  ClockMapping mapping() const noexcept;

 private:
  static constexpr std::size_t kPoints = 64;
  struct Point {
    std::int64_t quarter = 0;  // number of its quarter second
    double at_ns = 0;          // device time since the fit began
    double excess_ns = 0;      // arrival − device, less what it was when the fit began
  };
  const Point& point(std::size_t i) const noexcept { return points_[(first_ + i) % kPoints]; }
  void restart(std::int64_t device_ns, std::int64_t arrival_ns) noexcept;
  bool has_jumped(double at_ns, double excess_ns, std::int64_t arrival_ns) noexcept;
  void add(double at_ns, double excess_ns) noexcept;
  void fit() noexcept;
  double line(double at_ns) const noexcept { return intercept_ns_ + slope_ * at_ns; }

  std::array<Point, kPoints> points_{};
  std::size_t first_ = 0, held_ = 0;
  std::int64_t base_device_ns_ = 0, base_offset_ns_ = 0;
  std::int64_t last_arrival_ns_ = 0, last_mapped_ns_ = 0, behind_since_ns_ = 0;
  double last_at_ns_ = 0, intercept_ns_ = 0, slope_ = 0;
  std::atomic<std::int64_t> offset_ns_{0};
  std::atomic<double> drift_{0};
  std::atomic<std::uint64_t> restarts_{0};
  std::atomic<bool> valid_{false};
};

}  // namespace rptv
