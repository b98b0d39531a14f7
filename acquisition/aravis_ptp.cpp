// SPDX-License-Identifier: MIT
// The features of PTP under their two names, and the wait for a locked clock.
#include "acquisition/aravis_ptp.hpp"

#include <arv.h>

#include <array>

#include "core/clock.hpp"
#include "core/error.hpp"

namespace rptv {
namespace {

constexpr std::int64_t kBetweenReadings_ns = 100'000'000;

struct Features {
  const char *enable, *latch, *state, *offset;
};
// The standard's names since its version 2.2, and those that GigE Vision cameras had before.
constexpr std::array<Features, 2> kNames{
    {{"PtpEnable", "PtpDataSetLatch", "PtpStatus", "PtpOffsetFromMaster"},
     {"GevIEEE1588", "GevIEEE1588DataSetLatch", "GevIEEE1588Status", "GevIEEE1588OffsetFromMaster"}}};

const Features* features_of(ArvCamera* camera) {
  ArvFailure ignored;
  for (const Features& names : kNames)
    if (arv_camera_is_feature_available(camera, names.enable, ignored.out())) return &names;
  return nullptr;
}

}  // namespace

std::string PtpState::text() const {
  return ", PTP " + (state.empty() ? "unknown" : state) +
         (offset_known ? ", offset " + std::to_string(offset_ns) + " ns" : "");
}

PtpState read_ptp(ArvCamera* camera) {
  PtpState now;
  const Features* names = features_of(camera);
  if (names == nullptr) return now;
  ArvFailure failure;
  arv_camera_execute_command(camera, names->latch, failure.out());  // not every camera has to be told
  const char* state = arv_camera_get_string(camera, names->state, failure.out());
  if (!failure && state != nullptr) now.state = state;
  now.offset_ns = arv_camera_get_integer(camera, names->offset, failure.out());
  now.offset_known = !failure;
  return now;
}

void enable_ptp(ArvCamera* camera, const std::string& name) {
  const Features* names = features_of(camera);
  if (names == nullptr)
    throw Error(ExitCode::configuration,
                "camera " + name + " has neither PtpEnable nor GevIEEE1588; set aravis.ptp = false");
  ArvFailure failure;
  arv_camera_set_boolean(camera, names->enable, TRUE, failure.out());
  if (failure)
    throw Error(ExitCode::configuration,
                "camera " + name + " refuses PTP (" + failure.text() + "); set aravis.ptp = false");
}

PtpState wait_for_ptp(ArvCamera* camera, const std::string& name, double patience_s,
                      const std::function<bool(std::int64_t)>& rest) {
  const std::int64_t deadline_ns = host_now_ns() + static_cast<std::int64_t>(patience_s * 1e9);
  PtpState now = read_ptp(camera);
  while (!now.locked() && host_now_ns() < deadline_ns && rest(kBetweenReadings_ns)) now = read_ptp(camera);
  if (now.locked()) return now;
  throw Error(ExitCode::unavailable,
              "camera " + name + " has no PTP time after " + std::to_string(static_cast<int>(patience_s)) +
                  " s (its state is '" + now.state +
                  "'); check that a master answers on its network, or set aravis.ptp_wait_s higher");
}

}  // namespace rptv
