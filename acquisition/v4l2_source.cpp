// SPDX-License-Identifier: MIT
// The thread of each V4L2 camera, and what it does when its device goes away.
#include "acquisition/v4l2_source.hpp"

#include <pthread.h>
#include <sys/eventfd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <optional>

#include "acquisition/v4l2_device.hpp"
#include "core/descriptor.hpp"
#include "core/error.hpp"

namespace rptv {
namespace {

constexpr int kPatience_ms = 500;
// Opening a node that is not there costs microseconds; watching for it would need another library and tell no more.
constexpr int kReopen_ms = 200;

}  // namespace

class V4l2Source::Camera {
 public:
  Camera(V4l2System& system, const std::string& path, const V4l2Settings& settings, std::uint32_t number)
      : system_(system), path_(path), settings_(settings), number_(number), wake_(eventfd(0, EFD_CLOEXEC)) {
    if (!wake_.open()) throw Error(ExitCode::unavailable, "no eventfd for " + path + "; raise the limit of open files");
    device_.emplace(system_, path_, settings_);
    shape_ = device_->shape(), bits_ = device_->significant_bits(), period_ns_ = device_->period_ns();
    status_.device = device_->name();
    status_.link = settings.pixel_format + " " + std::to_string(shape_.width_px) + " x " +
                   std::to_string(shape_.height_px) + " px, " + std::to_string(settings.buffers) + " buffers, mmap";
  }

  CameraInfo info() const { return {path_, shape_, bits_}; }
  std::int64_t period_ns() const noexcept { return period_ns_; }

  void begin() {
    device_->start();
    tell(DeviceState::streaming, device_->otherwise());
    sessions_.fetch_add(1, std::memory_order_relaxed);
  }

  void run(FrameSink& sink) noexcept {
    while (!stopping_.load(std::memory_order_acquire)) {
      if (device_) stream(sink);
      device_.reset();
      if (!stopping_.load(std::memory_order_acquire)) reopen();
    }
    tell(DeviceState::stopped, "");
  }

  void end() noexcept {
    stopping_.store(true, std::memory_order_release);
    eventfd_write(wake_.get(), 1);
  }

  DeviceStatus status() const {
    const auto read = [](const Counter& counter) { return counter.load(std::memory_order_relaxed); };
    const std::lock_guard lock(status_lock_);
    DeviceStatus now = status_;
    now.sessions = read(sessions_);
    now.counters = {{"dequeued", read(dequeued_)},
                    {"torn", read(torn_)},
                    {"no_slot", read(no_slot_)},
                    {"sequence_gaps", read(gaps_)},
                    {"sequence_steps_back", read(backwards_)},
                    {"device_lost", read(lost_)}};
    return now;
  }

 private:
  using Counter = std::atomic<std::uint64_t>;
  static void add(Counter& counter, std::uint64_t count = 1) noexcept {
    counter.fetch_add(count, std::memory_order_relaxed);
  }

  void tell(DeviceState state, const std::string& problem) {
    const std::lock_guard lock(status_lock_);
    status_.state = state;
    status_.problem = problem;
  }

  void stream(FrameSink& sink) noexcept {
    while (!stopping_.load(std::memory_order_acquire)) {
      V4l2Image image;
      const auto took = device_->take(image, wake_.get(), kPatience_ms);
      if (took == V4l2Device::Took::nothing) continue;
      if (took == V4l2Device::Took::image) {
        deliver(sink, image);
        if (device_->give_back(image)) continue;
      }
      add(lost_);
      resumed_ = true;
      tell(DeviceState::lost,
           path_ + ": " + std::strerror(device_->last_errno()) + "; it is opened again when it is back");
      return;
    }
  }

  void deliver(FrameSink& sink, const V4l2Image& image) noexcept {
    add(dequeued_);
    follow(image);
    Frame frame;
    frame.shape = shape_;
    frame.info.index = index_;
    frame.info.camera = number_;
    frame.info.torn = image.torn;
    if (image.torn) {
      add(torn_);
    } else {
      frame.lease = sink.claim(number_);
      if (!frame.lease) return add(no_slot_);
      device_->copy(image, frame.lease.get());
    }
    frame.info.clock = image.clock;
    frame.info.exposure_end_ns = image.time_ns;
    frame.info.arrival_ns = host_now_ns();
    // Some drivers stamp the end that they expect, which may be still to come.
    const bool known = image.clock == ClockId::host_monotonic && image.time_ns < frame.info.arrival_ns;
    frame.info.exposure_end_host_ns = known ? image.time_ns : frame.info.arrival_ns;
    sink.deliver(std::move(frame));
  }

  /// Driver's 32 bits to our 64. A step back of less than half the range is a driver that counts anew. What a device
  /// missed while it was gone is estimated from its period, so that it is a gap.
  void follow(const V4l2Image& image) noexcept {
    const std::uint32_t step = image.sequence - sequence_;
    const std::int64_t away_ns = image.time_ns - last_time_ns_;
    sequence_ = image.sequence;
    last_time_ns_ = image.time_ns;
    if (!started_) {
      started_ = true;
      index_ = image.sequence;
    } else if (resumed_ || step > UINT32_MAX / 2) {
      if (!resumed_) add(backwards_);
      const bool timed = resumed_ && period_ns_ > 0 && image.clock == ClockId::host_monotonic && away_ns > period_ns_;
      index_ += timed ? static_cast<std::uint64_t>((away_ns + period_ns_ / 2) / period_ns_) : 1;
    } else {
      if (step > 1) add(gaps_, step - 1);
      index_ += step;
    }
    resumed_ = false;
  }

  /// Set-up again; between tries it sleeps until stop() or the time is over.
  void reopen() noexcept {
    try {
      device_.emplace(system_, path_, settings_);
      if (device_->shape() != shape_)
        throw Error(ExitCode::configuration, path_ + ": came back with another image size; start rapidptv again");
      begin();
      return;
    } catch (const std::exception& error) {
      tell(DeviceState::lost, error.what());
    }
    device_.reset();
    pollfd stop{wake_.get(), POLLIN, 0};
    system_.poll(&stop, 1, kReopen_ms);
  }

  V4l2System& system_;
  const std::string path_;
  const V4l2Settings settings_;
  const std::uint32_t number_;
  Descriptor wake_;
  std::atomic<bool> stopping_{false};
  std::optional<V4l2Device> device_;
  ImageShape shape_;
  std::uint32_t bits_ = 8;
  std::int64_t period_ns_ = 0;
  std::uint64_t index_ = 0;
  std::uint32_t sequence_ = 0;
  std::int64_t last_time_ns_ = 0;
  bool started_ = false;
  bool resumed_ = false;
  Counter sessions_{0}, dequeued_{0}, torn_{0}, no_slot_{0}, gaps_{0}, backwards_{0}, lost_{0};
  mutable std::mutex status_lock_;  // taken when a device comes or goes, never per frame
  DeviceStatus status_;
};

V4l2Source::V4l2Source(const V4l2Settings& settings, V4l2System* system) {
  if (settings.devices.empty())
    throw Error(ExitCode::configuration,
                "v4l2.devices is empty; name the cameras' nodes, for instance [\"/dev/video0\"]");
  for (const std::string& path : settings.devices) {
    const auto number = static_cast<std::uint32_t>(running_.size());
    running_.push_back(std::make_unique<Camera>(system != nullptr ? *system : real_, path, settings, number));
    cameras_.push_back(running_.back()->info());
  }
}

V4l2Source::~V4l2Source() { stop(); }

void V4l2Source::start(FrameSink& sink) {
  for (auto& camera : running_) camera->begin();
  for (std::size_t i = 0; i < running_.size(); ++i) {
    threads_.emplace_back([&sink, &camera = *running_[i]] { camera.run(sink); });
    pthread_setname_np(threads_.back().native_handle(), ("rptv-v4l2-" + std::to_string(i)).c_str());
  }
}

void V4l2Source::stop() noexcept {
  for (auto& camera : running_) camera->end();
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
}

std::int64_t V4l2Source::nominal_period_ns() const noexcept { return running_.front()->period_ns(); }

std::vector<DeviceStatus> V4l2Source::device_status() const {
  std::vector<DeviceStatus> all;
  for (const auto& camera : running_) all.push_back(camera->status());
  return all;
}

}  // namespace rptv
