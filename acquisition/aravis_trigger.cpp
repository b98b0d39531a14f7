// SPDX-License-Identifier: MIT
// One command for each multiple of the period that is not over yet.
#include "acquisition/aravis_trigger.hpp"

#include <arv.h>

namespace rptv {

void SoftwareTrigger::begin(std::int64_t now_ns) noexcept {
  if (period_ns_ > 0) due_ns_ = (now_ns / period_ns_ + 1) * period_ns_;
}

bool SoftwareTrigger::fire(ArvCamera* camera, std::int64_t now_ns) noexcept {
  if (now_ns < due_ns_) return true;
  const std::int64_t late = (now_ns - due_ns_) / period_ns_;
  skipped_.fetch_add(static_cast<std::uint64_t>(late), std::memory_order_relaxed);
  due_ns_ += (late + 1) * period_ns_;
  ArvFailure failure;
  arv_camera_software_trigger(camera, failure.out());
  if (failure) return false;
  fired_.fetch_add(1, std::memory_order_relaxed);
  return true;
}

}  // namespace rptv
