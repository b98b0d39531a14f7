// SPDX-License-Identifier: MIT
// A recording in image files as a Source: paced, looped, with faults on request.
#pragma once

#include <atomic>
#include <memory>
#include <thread>
#include <vector>

#include "acquisition/source.hpp"
#include "replay/camera_player.hpp"
#include "replay/replay_settings.hpp"

namespace rptv {

/// One thread per camera decodes (or, preloaded, copies) into the sink's slot ahead of the frame's deadline and
/// delivers at it. Times: exposure_end_ns from frames.csv or index / rate, going on over loops, not scaled by `speed`;
/// exposure_end_host_ns is the deadline (speed 0: when the slot was there); arrival_ns is the moment of delivery. A
/// frame that is behind its deadline leaves at once and keeps its stamp, so that latency shows it; the schedule never
/// slips. Preloaded, nothing allocates, locks or throws after start(); else libpng and libtiff allocate, and what they
/// cannot decode is delivered as torn, counted, and named by failure().
class ReplaySource final : public Source {
 public:
  /// Finds and checks all images, and decodes them if `preload` is set. Throws Error; see open_cameras(),
  /// make_timeline() and preload().
  explicit ReplaySource(const ReplaySettings& settings, const PreloadProgress& progress = {});
  ~ReplaySource() override;

  const std::vector<CameraInfo>& cameras() const noexcept override { return cameras_; }
  void start(FrameSink& sink) override;
  /// Close a lossless sink first: a player that waits in its claim() hears nothing else.
  void stop() noexcept override;
  std::int64_t nominal_period_ns() const noexcept override { return play_->timeline.period_ns; }
  std::string failure() const override { return play_->failure.get(); }

  /// Instants of all loops together; UINT64_MAX when it plays for ever.
  std::uint64_t instants() const noexcept { return play_->steps; }
  /// What was done to the frames of a camera so far. Any thread.
  InjectedFaults injected(std::uint32_t camera) const noexcept { return players_[camera]->injected(); }
  /// Frames of a camera that could not be decoded while playing. Any thread.
  std::uint64_t undecodable(std::uint32_t camera) const noexcept { return players_[camera]->undecodable(); }
  /// Longest time by which a frame was ready to leave after its deadline, over all cameras; 0 at speed 0. Any thread.
  std::int64_t worst_lateness_ns() const noexcept;

 private:
  std::vector<ImageSequence> sequences_;
  std::vector<DecodedImages> decoded_;
  std::vector<CameraInfo> cameras_;
  std::unique_ptr<Play> play_;
  std::vector<std::unique_ptr<CameraPlayer>> players_;
  std::vector<std::thread> threads_;
  std::atomic<std::size_t> playing_{0};
};

}  // namespace rptv
