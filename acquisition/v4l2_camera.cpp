// SPDX-License-Identifier: MIT
// The thread of a V4L2 camera.
#include "acquisition/v4l2_camera.hpp"

#include <sys/eventfd.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "acquisition/v4l2_watch.hpp"
#include "core/error.hpp"

namespace rptv {
namespace {

constexpr int kPatience_ms = 500;
// Between two tries to open a lost device: soon at first and after it was plugged in, then ever more rarely. A device
// that nobody hears of is looked for more often.
constexpr int kFirstTry_ms = 20, kUnheardTry_ms = 200, kRareTry_ms = 2000;

void add(std::atomic<std::uint64_t>& counter, std::uint64_t count = 1) noexcept {
  counter.fetch_add(count, std::memory_order_relaxed);
}

std::string size_of(const ImageShape& shape) {
  return std::to_string(shape.width_px) + " x " + std::to_string(shape.height_px) + " px";
}

}  // namespace

V4l2Camera::V4l2Camera(V4l2System& system, const std::string& path, const V4l2Settings& settings, std::uint32_t number,
                       std::size_t pool_frames)
    : system_(system),
      path_(path),
      settings_(settings),
      number_(number),
      wake_(eventfd(0, EFD_CLOEXEC)),
      loan_(number, std::clamp<std::size_t>(pool_frames / 2, 2, static_cast<std::size_t>(settings.buffers))) {
  if (!wake_.open()) throw Error(ExitCode::unavailable, "no eventfd for " + path + "; raise the limit of open files");
  device_.emplace(system_, path_, settings_, loan_);
  shape_ = device_->shape(), bits_ = device_->significant_bits(), period_ns_ = device_->period_ns();
  status_.device = device_->name();
}

void V4l2Camera::begin(FrameSink& sink) {
  device_->start(sink);
  {
    const std::lock_guard lock(status_lock_);
    status_.link = device_->link();
  }
  tell(DeviceState::streaming, device_->otherwise());
  add(sessions_);
}

void V4l2Camera::run(FrameSink& sink) noexcept {
  while (!stopping()) {
    stream(sink);
    device_.reset();
    open_again(sink);
  }
  close();
}

void V4l2Camera::end() noexcept {
  stopping_.store(true, std::memory_order_release);
  eventfd_write(wake_.get(), 1);
}

void V4l2Camera::close() noexcept {
  device_.reset();
  loan_.end();
  tell(DeviceState::stopped, "");
}

DeviceStatus V4l2Camera::status() const {
  const auto read = [](const Counter& counter) { return counter.load(std::memory_order_relaxed); };
  const std::lock_guard lock(status_lock_);
  DeviceStatus now = status_;
  now.sessions = read(sessions_);
  now.counters = {{"dequeued", read(dequeued_)},
                  {"torn", read(torn_)},
                  {"no_slot", read(no_slot_)},
                  {"sequence_gaps", read(gaps_)},
                  {"sequence_steps_back", read(backwards_)},
                  {"device_lost", read(lost_)},
                  {"source_changes", read(changed_)},
                  {"plug_events", read(came_)}};
  return now;
}

void V4l2Camera::tell(DeviceState state, const std::string& problem) {
  const std::lock_guard lock(status_lock_);
  status_.state = state;
  status_.problem = problem;
}

void V4l2Camera::stream(FrameSink& sink) noexcept {
  while (device_ && !stopping()) {
    V4l2Image image;
    const auto took = device_->take(image, wake_.get(), kPatience_ms);
    if (took == V4l2Device::Took::nothing) continue;
    if (took == V4l2Device::Took::image) {
      deliver(sink, image);
      if (device_->give_back(image)) continue;
    }
    const bool changed = took == V4l2Device::Took::changed;
    add(changed ? changed_ : lost_);
    resumed_ = true;
    tell(DeviceState::lost,
         path_ + ": " +
             (changed ? std::string("its source changed; it is set up anew")
                      : std::strerror(device_->last_errno()) + std::string("; it is opened again when it is back")));
    return;
  }
}

void V4l2Camera::deliver(FrameSink& sink, V4l2Image& image) noexcept {
  add(dequeued_);
  follow(sink, image);
  Frame frame;
  frame.shape = shape_;
  frame.info.index = index_;
  frame.info.camera = number_;
  frame.info.torn = image.torn;
  if (image.torn) {
    add(torn_);
  } else {
    FrameLease slot = sink.claim(number_);
    if (!slot) return add(no_slot_);
    frame.lease = device_->exchange(image, std::move(slot));
  }
  frame.info.clock = image.clock;
  frame.info.exposure_end_ns = image.time_ns;
  frame.info.arrival_ns = host_now_ns();
  // Some drivers stamp the end that they expect, which may be still to come.
  const bool known = image.clock == ClockId::host_monotonic && image.time_ns < frame.info.arrival_ns;
  frame.info.exposure_end_host_ns = known ? image.time_ns : frame.info.arrival_ns;
  sink.deliver(std::move(frame));
}

/// Images leave a driver in their order, so a step back of its 32 bits is one that counts anew. What a device missed
/// while it was gone is estimated from its period.
void V4l2Camera::follow(FrameSink& sink, const V4l2Image& image) noexcept {
  const std::uint32_t step = image.sequence - sequence_;
  const std::int64_t away_ns = image.time_ns - last_time_ns_;
  const bool first = !counter_.started();
  const bool back = !first && !resumed_ && step > UINT32_MAX / 2;
  const bool timed = resumed_ && period_ns_ > 0 && image.clock == ClockId::host_monotonic && away_ns > period_ns_;
  if (back) add(backwards_);
  const auto due = timed ? static_cast<std::uint64_t>((away_ns + period_ns_ / 2) / period_ns_) - 1 : 0;
  if (back || resumed_)
    counter_.reopen(due);
  else if (!first && step > 1)
    add(gaps_, step - 1);
  index_ = counter_.index_of(image.sequence);
  if (due > 0) sink.lose(number_, LossCause::source_outage, due);
  if (resumed_ && !first) {
    const std::lock_guard lock(status_lock_);
    status_.last_outage = {status_.last_outage.number + 1, index_, away_ns, due};
  }
  sequence_ = image.sequence;
  last_time_ns_ = image.time_ns;
  resumed_ = false;
}

/// Until the device streams again, or stop.
void V4l2Camera::open_again(FrameSink& sink) noexcept {
  V4l2Watch watch;  // listens before the first try, so that no coming is missed
  const int rarest_ms = watch.descriptor() < 0 ? kUnheardTry_ms : kRareTry_ms;
  for (int pause_ms = kFirstTry_ms; !stopping(); pause_ms = std::min(2 * pause_ms, rarest_ms)) {
    try {
      device_.emplace(system_, path_, settings_, loan_);
      if (device_->shape() != shape_)
        throw Error(ExitCode::configuration, path_ + ": came back with " + size_of(device_->shape()) + " where " +
                                                 size_of(shape_) + " were; set it back, or start rapidptv again");
      begin(sink);
      break;
    } catch (const std::exception& error) {
      device_.reset();
      tell(DeviceState::lost, error.what());
    }
    pollfd waited[2] = {{wake_.get(), POLLIN, 0}, {watch.descriptor(), POLLIN, 0}};
    system_.poll(waited, 2, pause_ms);
    const unsigned came = watch.take();
    add(came_, came);
    if (came > 0) pause_ms = kFirstTry_ms / 2;
  }
  add(came_, watch.take());
}

}  // namespace rptv
