// SPDX-License-Identifier: MIT
// Waiting for one image of each camera, writing it, and its grey values.
#include "daemon/snapshot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <memory>

#include "core/error.hpp"
#include "core/json.hpp"
#include "core/wake.hpp"
#include "daemon/session.hpp"
#include "replay/image_file.hpp"

namespace rptv {
namespace {

/// Keeps the first whole frame of each camera and has no slot for any later one.
class FirstFrames final : public FrameSink {
 public:
  FirstFrames(const std::vector<CameraInfo>& cameras, std::size_t slots) {
    for (const CameraInfo& camera : cameras) lanes_.push_back(std::make_unique<Lane>(slots, camera.shape.bytes()));
  }
  FrameLease claim(std::uint32_t camera) noexcept override {
    return lanes_[camera]->full ? FrameLease{} : lanes_[camera]->pool.claim();
  }
  void deliver(Frame&& frame) noexcept override {
    const Frame mine = std::move(frame);
    Lane& lane = *lanes_[mine.info.camera];
    if (lane.full || mine.info.torn || !mine.lease) return;
    lane.first.info = mine.info;
    lane.first.shape = mine.shape;
    lane.first.lease = mine.lease.share();
    lane.full = true;
    progress_.notify();
  }
  void lose(std::uint32_t, LossCause, std::uint64_t) noexcept override {}
  void end() noexcept override {
    ended_ = true;
    progress_.notify();
  }

  /// False when the time is over, or the source has ended, without an image of the camera.
  bool wait_for(std::uint32_t camera, std::int64_t deadline_ns) noexcept {
    while (!lanes_[camera]->full) {
      const std::uint32_t seen = progress_.prepare();
      const std::int64_t left_ns = deadline_ns - host_now_ns();
      if (lanes_[camera]->full) break;
      if (ended_ || left_ns <= 0) return false;
      progress_.wait(seen, left_ns);
    }
    return true;
  }
  const Frame& first(std::uint32_t camera) const noexcept { return lanes_[camera]->first; }

 private:
  struct Lane {
    Lane(std::size_t slots, std::size_t bytes) : pool(slots, bytes) {}
    FramePool pool;
    Frame first;
    std::atomic<bool> full{false};
  };
  std::vector<std::unique_ptr<Lane>> lanes_;
  std::atomic<bool> ended_{false};
  Wake progress_;
};

/// Stops it before the sink goes, also when something throws.
struct Running {
  Source& source;
  Running(Source& s, FrameSink& sink) : source(s) { source.start(sink); }
  ~Running() { source.stop(); }
};

template <class Pixel>
void measure(const Pixel* pixels, std::size_t count, Snapshot& snapshot) {
  const std::uint32_t full_scale = (1U << snapshot.camera.significant_bits) - 1;
  const auto [least, greatest] = std::minmax_element(pixels, pixels + count);
  std::uint64_t sum = 0, saturated = 0;
  for (std::size_t i = 0; i < count; ++i) {
    sum += pixels[i];
    saturated += pixels[i] >= full_scale;
  }
  snapshot.minimum = *least;
  snapshot.maximum = *greatest;
  snapshot.mean = static_cast<double>(sum) / static_cast<double>(count);
  snapshot.saturated = static_cast<double>(saturated) / static_cast<double>(count);
}

std::filesystem::path file_for(const std::filesystem::path& out, const std::string& camera, bool several) {
  std::string name = camera.substr(std::min(camera.find_first_not_of('/'), camera.size()));
  std::replace(name.begin(), name.end(), '/', '_');
  if (out.empty()) return name + ".png";
  if (std::filesystem::is_directory(out)) return out / (name + ".png");
  if (!several) return out;
  return out.parent_path() / (out.stem().string() + "-" + name + out.extension().string());
}

[[noreturn]] void fail(const Source& source, const CameraInfo& camera, std::uint32_t number) {
  if (!source.failure().empty()) throw Error(ExitCode::io, source.failure());
  const auto devices = source.device_status();
  if (devices.empty()) throw Error(ExitCode::no_input, camera.name + ": the recording has no whole image of it");
  const DeviceStatus& device = devices[number];
  throw Error(ExitCode::unavailable,
              "camera " + camera.name + " gave no image in time (" + device.link +
                  "): " + (device.problem.empty() ? "check its trigger, then run `rapidptv doctor`" : device.problem));
}

constexpr const char* name_of_clock(ClockId clock) noexcept {
  constexpr const char* kNames[]{"host", "device", "ptp", "recording", "nominal"};
  return kNames[static_cast<std::size_t>(clock)];
}

}  // namespace

std::vector<Snapshot> take_snapshots(const Config& config, const std::filesystem::path& out, std::int64_t patience_ns) {
  const auto source = make_source(config);
  const auto& cameras = source->cameras();
  FirstFrames sink(cameras, static_cast<std::size_t>(config.intake.pool_frames));
  const Running running(*source, sink);
  const std::int64_t deadline_ns = host_now_ns() + patience_ns;
  std::vector<Snapshot> snapshots;
  for (std::uint32_t c = 0; c < cameras.size(); ++c) {
    if (!sink.wait_for(c, deadline_ns)) fail(*source, cameras[c], c);
    const Frame& frame = sink.first(c);
    Snapshot one{.camera = cameras[c], .file = file_for(out, cameras[c].name, cameras.size() > 1), .link = {}};
    one.clock = frame.info.clock;
    one.exposure_end_ns = frame.info.exposure_end_ns;
    frame.shape.bytes_per_pixel == 1 ? measure(frame.view().as_u8(), frame.shape.pixels(), one)
                                     : measure(frame.view().as_u16(), frame.shape.pixels(), one);
    const auto devices = source->device_status();
    if (c < devices.size()) one.link = devices[c].link;
    write_png(one.file, frame.view(), one.camera.significant_bits);
    snapshots.push_back(std::move(one));
  }
  return snapshots;
}

std::string to_text(const Snapshot& s) {
  return fmt::format(
      "{}: {}, {} × {} px, {} bit; values {} to {}, mean {:.1f}, {:.3f} % saturated; {} clock {:.6f} s{}",
      s.camera.name, s.file.string(), s.camera.shape.width_px, s.camera.shape.height_px, s.camera.significant_bits,
      s.minimum, s.maximum, s.mean, 100 * s.saturated, name_of_clock(s.clock),
      static_cast<double>(s.exposure_end_ns) * 1e-9, s.link.empty() ? "" : "; " + s.link);
}

std::string to_json(const Snapshot& s) {
  return fmt::format(
      R"({{"camera": {}, "file": {}, "width_px": {}, "height_px": {}, "significant_bits": {}, "minimum": {}, )"
      R"("maximum": {}, "mean": {}, "saturated": {}, "clock": {}, "exposure_end_ns": {}, "link": {}}})",
      json_string(s.camera.name), json_string(s.file.string()), s.camera.shape.width_px, s.camera.shape.height_px,
      s.camera.significant_bits, s.minimum, s.maximum, json_number(s.mean), json_number(s.saturated),
      json_string(name_of_clock(s.clock)), s.exposure_end_ns, json_string(s.link));
}

}  // namespace rptv
