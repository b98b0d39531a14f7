// SPDX-License-Identifier: MIT
// The lower hull of offsets, its middle edge, and when to begin anew.
#include "acquisition/device_clock.hpp"

#include <algorithm>
#include <cmath>

namespace rptv {
namespace {

constexpr double kQuarterNs = 250e6;
constexpr double kFitSpanNs = 2e9;     // a drift from less is mostly jitter
constexpr double kMostDrift = 500e-6;  // crystals do 200 ppm at worst
constexpr double kJumpNs = 10e6;       // an exposure so long after its arrival is a jump of the clock
constexpr double kBehindNs = 100e6;    // a delay so long, for kBehindForNs, is one as well
constexpr double kMostDelayNs = 1e18;  // far from overflow
constexpr std::int64_t kBehindForNs = 1'000'000'000;

// A hostile device may show any 64 bits: wraps instead of overflowing.
std::int64_t difference(std::int64_t a, std::int64_t b) noexcept {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
}

}  // namespace

std::int64_t DeviceClock::map(std::int64_t device_ns, std::int64_t arrival_ns) noexcept {
  if (held_ == 0) restart(device_ns, arrival_ns);
  auto at_ns = static_cast<double>(difference(device_ns, base_device_ns_));
  auto excess_ns = static_cast<double>(difference(difference(arrival_ns, device_ns), base_offset_ns_));
  if (has_jumped(at_ns, excess_ns, arrival_ns)) {
    restarts_.fetch_add(1, std::memory_order_relaxed);
    restart(device_ns, arrival_ns);
    at_ns = excess_ns = 0;
  }
  add(at_ns, excess_ns);
  last_at_ns_ = at_ns;
  last_arrival_ns_ = arrival_ns;
  // The line passes below every point of its window, this one included; the rounding may not.
  const auto delay_ns = static_cast<std::int64_t>(std::clamp(excess_ns - line(at_ns), 0.0, kMostDelayNs));
  last_mapped_ns_ = std::min(arrival_ns, std::max(last_mapped_ns_, arrival_ns - delay_ns));
  offset_ns_.store(difference(difference(arrival_ns, device_ns), delay_ns), std::memory_order_relaxed);
  drift_.store(slope_, std::memory_order_relaxed);
  valid_.store(true, std::memory_order_relaxed);
  return last_mapped_ns_;
}

ClockMapping DeviceClock::mapping() const noexcept {
  return {.valid = valid_.load(std::memory_order_relaxed),
          .offset_ns = offset_ns_.load(std::memory_order_relaxed),
          .drift_ppm = drift_.load(std::memory_order_relaxed) * 1e6,
          .restarts = restarts_.load(std::memory_order_relaxed)};
}

void DeviceClock::restart(std::int64_t device_ns, std::int64_t arrival_ns) noexcept {
  first_ = held_ = 0;
  base_device_ns_ = device_ns;
  base_offset_ns_ = difference(arrival_ns, device_ns);
  behind_since_ns_ = 0;
  last_at_ns_ = intercept_ns_ = slope_ = 0;
}

bool DeviceClock::has_jumped(double at_ns, double excess_ns, std::int64_t arrival_ns) noexcept {
  if (held_ == 0) return false;
  if (at_ns < last_at_ns_) return true;
  const double since_ns = at_ns - last_at_ns_;
  const double below_ns = line(at_ns) - excess_ns;
  // Before there is a line, the frames so far may all have been late.
  const double jump_ns = at_ns - point(0).at_ns < kFitSpanNs ? 1e9 : kJumpNs;
  if (below_ns > jump_ns + kMostDrift * since_ns) return true;
  if (below_ns > -(kBehindNs + kMostDrift * since_ns)) {
    behind_since_ns_ = 0;
    return false;
  }
  if (behind_since_ns_ == 0) behind_since_ns_ = arrival_ns;
  return arrival_ns - behind_since_ns_ > kBehindForNs;
}

// Keeps the least of each quarter second; those without frames take no place.
void DeviceClock::add(double at_ns, double excess_ns) noexcept {
  const auto quarter = static_cast<std::int64_t>(at_ns / kQuarterNs);
  if (held_ != 0) {
    Point& newest = points_[(first_ + held_ - 1) % kPoints];
    if (newest.quarter == quarter) {
      if (excess_ns >= newest.excess_ns) return;
      newest = {quarter, at_ns, excess_ns};
      return fit();
    }
  }
  if (held_ == kPoints) {
    first_ = (first_ + 1) % kPoints;
    --held_;
  }
  points_[(first_ + held_++) % kPoints] = {quarter, at_ns, excess_ns};
  fit();
}

void DeviceClock::fit() noexcept {
  double middle_ns = 0, least_ns = point(0).excess_ns;
  for (std::size_t i = 0; i < held_; ++i) {
    middle_ns += point(i).at_ns / static_cast<double>(held_);
    least_ns = std::min(least_ns, point(i).excess_ns);
  }
  slope_ = 0;
  intercept_ns_ = least_ns;
  if (point(held_ - 1).at_ns - point(0).at_ns < kFitSpanNs) return;
  std::array<std::size_t, kPoints> hull{};
  std::size_t corners = 0;
  for (std::size_t i = 0; i < held_; ++i) {
    while (corners >= 2) {
      const Point &a = point(hull[corners - 2]), &b = point(hull[corners - 1]), &c = point(i);
      const bool below =
          (b.excess_ns - a.excess_ns) * (c.at_ns - a.at_ns) < (c.excess_ns - a.excess_ns) * (b.at_ns - a.at_ns);
      if (below) break;
      --corners;
    }
    hull[corners++] = i;
  }
  std::size_t edge = 0;
  while (edge + 2 < corners && point(hull[edge + 1]).at_ns < middle_ns) ++edge;
  const Point &from = point(hull[edge]), &to = point(hull[edge + 1]);
  slope_ = std::clamp((to.excess_ns - from.excess_ns) / (to.at_ns - from.at_ns), -kMostDrift, kMostDrift);
  intercept_ns_ = from.excess_ns - slope_ * from.at_ns;
  for (std::size_t i = 0; i < held_; ++i)  // only a clamped slope can leave a point below
    intercept_ns_ = std::min(intercept_ns_, point(i).excess_ns - slope_ * point(i).at_ns);
}

}  // namespace rptv
