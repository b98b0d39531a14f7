// SPDX-License-Identifier: MIT
// The trigger train, and what each camera makes of it.
#include "tests/acquisition/synced_cameras.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "acquisition/device_clock.hpp"
#include "acquisition/frame_counter.hpp"

namespace rptv {
namespace {

constexpr std::int64_t kStartNs = 5'000'000'000;
constexpr std::int64_t kDelayNs = 2'000'000;  // that every frame has, and nobody can know
constexpr std::int64_t kPtpEpochNs = 1'700'000'000'000'000'000;

std::int64_t time_of(const TriggerTrain& train, std::uint64_t trigger) {
  return kStartNs + static_cast<std::int64_t>(trigger) * train.period_ns +
         static_cast<std::int64_t>(trigger / 50) * train.pause_ns;
}

class Playing {
 public:
  Playing(const SyncedCamera& camera, std::uint32_t number, const TriggerTrain& train, std::uint64_t seed)
      : camera_(camera), number_(number), train_(train), random_(seed), id_(camera.first_id) {}

  void play(std::vector<Shown>& into) {
    for (std::uint64_t trigger = camera_.first; trigger < train_.triggers; ++trigger) {
      if (trigger >= camera_.leaves_at && trigger < camera_.returns_at) continue;
      if (trigger == camera_.returns_at) come_back(trigger);
      if (happens(camera_.miss)) continue;
      const std::uint64_t id = id_;
      id_ = id_ == 65'535 ? 1 : id_ + 1;
      if (happens(camera_.drop)) continue;
      const Shown shown{trigger, info_of(trigger, id)};
      into.push_back(shown);
      if (happens(camera_.repeat)) into.push_back(shown);
    }
  }

 private:
  bool happens(int percent) { return static_cast<int>(random_() % 100) < percent; }
  void come_back(std::uint64_t trigger) {
    id_ = 1;
    counter_.reopen(camera_.missed_guess);
    if (camera_.clock_starts_anew) clock_zero_ns_ = time_of(train_, trigger);
  }
  FrameInfo info_of(std::uint64_t trigger, std::uint64_t id) {
    const std::int64_t at_ns = time_of(train_, trigger);
    const auto jitter = static_cast<std::uint64_t>(train_.jitter_ns) + 1;
    last_arrival_ns_ = std::max(last_arrival_ns_, at_ns + kDelayNs + static_cast<std::int64_t>(random_() % jitter));
    FrameInfo info;
    info.camera = number_;
    info.index = counter_.index_of(id);
    info.arrival_ns = last_arrival_ns_;
    info.clock = train_.ptp ? ClockId::ptp : ClockId::device;
    const double runs = 1 + camera_.drift_ppm * 1e-6;
    info.exposure_end_ns = train_.ptp ? kPtpEpochNs + at_ns + static_cast<std::int64_t>(random_() % 1000)
                                      : std::llround(static_cast<double>(at_ns - clock_zero_ns_) * runs);
    info.exposure_end_host_ns = clock_.map(info.exposure_end_ns, info.arrival_ns);
    return info;
  }

  const SyncedCamera camera_;
  const std::uint32_t number_;
  const TriggerTrain train_;
  std::mt19937_64 random_;
  FrameCounter counter_;
  DeviceClock clock_;
  std::uint64_t id_;
  std::int64_t clock_zero_ns_ = -20'000'000'000;
  std::int64_t last_arrival_ns_ = 0;
};

}  // namespace

std::vector<Shown> show(const std::vector<SyncedCamera>& cameras, const TriggerTrain& train, std::uint64_t seed) {
  std::vector<Shown> all;
  for (std::uint32_t i = 0; i < cameras.size(); ++i) Playing(cameras[i], i, train, seed + i).play(all);
  std::stable_sort(all.begin(), all.end(),
                   [](const Shown& a, const Shown& b) { return a.info.arrival_ns < b.info.arrival_ns; });
  return all;
}

}  // namespace rptv
