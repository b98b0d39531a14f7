// SPDX-License-Identifier: MIT
// Draws of the fault plan.
#include "replay/fault_plan.hpp"

#include "core/error.hpp"

namespace rptv {
namespace {

enum Purpose : std::uint32_t { kFrame, kKept, kBunch, kClock, kOrder, kLateCamera };

std::uint64_t mixed(std::uint64_t x) noexcept {
  x += 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31);
}

}  // namespace

FaultPlan::FaultPlan(const ReplayFaults& faults) : faults_(faults) {
  const double sum = faults.drop_fraction + faults.duplicate_fraction + faults.torn_fraction;
  if (sum > 1)
    throw Error(ExitCode::configuration,
                "replay.faults: drop_fraction + duplicate_fraction + torn_fraction = " + std::to_string(sum) +
                    "; a frame has one of them at most: lower them to 1");
}

double FaultPlan::draw(std::uint64_t step, std::uint32_t camera, std::uint32_t purpose) const noexcept {
  const std::uint64_t which = (std::uint64_t{camera} << 32) | purpose;
  const std::uint64_t bits = mixed(mixed(mixed(static_cast<std::uint64_t>(faults_.seed)) ^ step) ^ which);
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

FrameFault FaultPlan::frame_fault(std::uint64_t step, std::uint32_t camera) const noexcept {
  double u = draw(step, camera, kFrame);
  if (u < faults_.drop_fraction) return FrameFault::drop;
  u -= faults_.drop_fraction;
  if (u < faults_.duplicate_fraction) return FrameFault::duplicate;
  u -= faults_.duplicate_fraction;
  return u < faults_.torn_fraction ? FrameFault::torn : FrameFault::none;
}

double FaultPlan::kept_fraction(std::uint64_t step, std::uint32_t camera) const noexcept {
  return draw(step, camera, kKept);
}

bool FaultPlan::waits_for_next(std::uint64_t step, std::uint32_t camera) const noexcept {
  // The last of each block of kLongestBunch never waits, so the others of the block wait a little more often.
  if (step % kLongestBunch == kLongestBunch - 1) return false;
  constexpr double kShare = static_cast<double>(kLongestBunch) / static_cast<double>(kLongestBunch - 1);
  return draw(step, camera, kBunch) < faults_.bunch_fraction * kShare;
}

bool FaultPlan::clock_jumps(std::uint64_t step, std::uint32_t camera) const noexcept {
  return draw(step, camera, kClock) < faults_.clock_jump_fraction;
}

bool FaultPlan::is_late(std::uint64_t step, std::uint32_t camera, std::uint32_t cameras) const noexcept {
  if (cameras < 2 || step % 2 != 0 || !(draw(step, 0, kOrder) < 2 * faults_.reorder_fraction)) return false;
  return camera == static_cast<std::uint32_t>(draw(step, 0, kLateCamera) * cameras);
}

}  // namespace rptv
