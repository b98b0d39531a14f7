// SPDX-License-Identifier: MIT
// Intake with real threads and hostile cameras: whatever they do and whatever the policy, every frame is accounted for.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <string>
#include <vector>

#include "tests/acquisition/hostile_camera.hpp"
#include "tests/core/workload.hpp"

namespace rptv {
namespace {

Faults any_faults() {
  const auto percent = rc::gen::weightedOneOf<int>({{2, rc::gen::just(0)}, {1, rc::gen::inRange(0, 40)}});
  Faults faults;
  faults.drop = *percent;
  faults.duplicate = *percent;
  faults.reorder = *percent;
  faults.torn = *percent;
  faults.delay = *percent;
  faults.first += *rc::gen::element<std::uint64_t>(0, 0, 1, 50);   // starts late
  faults.last -= *rc::gen::element<std::uint64_t>(0, 0, 60, 250);  // stops early, or was never there
  faults.leaves_at = faults.first + *rc::gen::inRange<std::uint64_t>(0, 100);
  faults.away = *rc::gen::element<std::uint64_t>(0, 0, 1, 80);  // and returns
  return faults;
}

IntakeOptions any_options(const HandOverPolicy& policy) {
  IntakeOptions options;
  options.policy = policy;
  options.bundle_patience_frames = *rc::gen::inRange<std::size_t>(0, 6);
  options.pool_frames_per_camera = options.bundle_patience_frames + 7 + *rc::gen::inRange<std::size_t>(0, 10);
  options.stall_ns = 20'000;
  return options;
}

void accounts_for_every_frame(const HandOverPolicy& policy) {
  const auto cameras = *rc::gen::inRange<std::size_t>(1, 5);
  const IntakeOptions options = any_options(policy);
  const auto seed = *rc::gen::arbitrary<std::uint64_t>();
  const auto dawdle = *rc::gen::element(0, 1, 20);
  std::vector<std::vector<Shot>> scripts;
  for (std::size_t camera = 0; camera < cameras; ++camera) scripts.push_back(script_of(any_faults(), seed + camera));
  std::vector<Expected> expected;
  {
    Intake intake(small_cameras(cameras), options);
    const Found found = run_cameras(intake, scripts, expected, dawdle);
    const std::string wrong = account(intake, found, expected, options.pool_frames_per_camera);
    if (!wrong.empty()) RC_FAIL(wrong);
    RC_TAG(std::string(found.indices.empty() ? "no set" : "sets"));
  }
}

RC_GTEST_PROP(IntakeOfHostileCameras, accounts_for_every_frame_when_newest, ()) { accounts_for_every_frame(Newest{}); }

RC_GTEST_PROP(IntakeOfHostileCameras, accounts_for_every_frame_when_lossless, ()) {
  accounts_for_every_frame(Lossless{*rc::gen::inRange<std::size_t>(0, 5)});
}

RC_GTEST_PROP(IntakeOfHostileCameras, accounts_for_every_frame_when_bounded, ()) {
  accounts_for_every_frame(Bounded{*rc::gen::inRange<std::size_t>(0, 5)});
}

}  // namespace
}  // namespace rptv
