// SPDX-License-Identifier: MIT
// The pipeline's front door: gives sources their frame slots, checks what they deliver and bundles cameras into sets.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <thread>
#include <vector>

#include "acquisition/bundler.hpp"
#include "acquisition/device_clock.hpp"
#include "acquisition/source.hpp"
#include "core/hand_over.hpp"
#include "core/losses.hpp"
#include "core/wake.hpp"

namespace rptv {

struct IntakeOptions {
  HandOverPolicy policy = Newest{};
  /// Slots that each camera may have in use, downstream included. Several cameras need bundle_patience_frames + 7.
  std::size_t pool_frames_per_camera = 16;
  /// With several cameras: how many newer frames of another camera may come before an incomplete set is given up.
  /// Lossless makes the camera that is ahead wait instead, and gives up only after `stall_ns`.
  std::size_t bundle_patience_frames = 4;
  /// Lossless with several cameras: a camera that gives nothing for so long while another is made to wait for it counts
  /// as silent, and is not waited for until its next frame. Breaks the deadlock of one thread that reads all cameras.
  std::int64_t stall_ns = 1'000'000'000;
  /// With several cameras: how frames are told to be of one instant, and how long a set may wait for its last frame.
  PairingOptions pairing = {};
  std::int64_t bound_ns = BundlerOptions::kNoBound;
};

/// FrameSink side: the source's threads. next(): one consumer thread. Counters and close(): any thread. All memory is
/// taken by the constructor. Frame sets must be gone before the Intake is.
///
/// One camera: its frames pass straight from its thread to the consumer under `policy`. Several: a thread of the Intake
/// pairs them (see Bundler), and `policy` applies to sets. It must be a thread: under `newest` a set is superseded
/// while the consumer is busy, and superseding single frames would break pairs.
///
/// Every delivered frame is in one set or counted once in losses(camera). Indices that were skipped and that neither a
/// failed claim nor lose() explains count as `source_gap`; a repeated index as `source_duplicate`; one that comes after
/// a newer one as `set_stale` (its gap stays counted); an incomplete frame as `source_torn`. A camera that reconnects
/// must go on with larger indices. Frames with a device's or PTP's time get their host time here, see DeviceClock.
class Intake final : public FrameSink {
 public:
  /// Throws Error(configuration) for no or too many cameras and for a pool too small to bundle.
  Intake(const std::vector<CameraInfo>& cameras, const IntakeOptions& options);
  ~Intake() override;

  FrameLease claim(std::uint32_t camera) noexcept override;
  void deliver(Frame&& frame) noexcept override;
  void lose(std::uint32_t camera, LossCause cause, std::uint64_t count) noexcept override;
  void end() noexcept override { close(); }

  /// Waits up to `timeout_ns` for the next complete set; frame indices of successive sets strictly increase. Drops what
  /// `set` holds first.
  Taken next(FrameSet& set, std::int64_t timeout_ns) noexcept;
  /// Ends the stream: claim() and deliver() refuse from now on, next() drains what is in flight and then says closed.
  void close() noexcept;

  const Losses& losses(std::uint32_t camera) const noexcept;
  /// Frames given to deliver(), whatever became of them.
  std::uint64_t delivered(std::uint32_t camera) const noexcept;
  /// How the camera's clock stands to the host's; not valid while no frame with a device's time came.
  ClockMapping clock_mapping(std::uint32_t camera) const noexcept;
  /// How far the camera's times lie from the first camera's; no sets with one camera.
  ClockSkew skew(std::uint32_t camera) const noexcept { return bundler_ ? bundler_->skew(camera) : ClockSkew{}; }
  std::size_t cameras() const noexcept { return lanes_.size(); }
  /// Where all frames of a camera lie; as long as this lives.
  std::span<std::byte> frame_memory(std::uint32_t camera) noexcept;
  /// Slots of the camera that nobody holds, at some moment during the call.
  std::size_t free_slots(std::uint32_t camera) const noexcept;

 private:
  struct Lane;  // acquisition/lane.hpp
  bool accept(Lane& lane, const Frame& frame) noexcept;
  bool drain(std::uint32_t camera, std::int64_t now_ns) noexcept;
  bool drain_all(std::int64_t now_ns) noexcept;
  void publish(FrameSet& set) noexcept;
  std::int64_t break_stall(std::int64_t& stalled_since_ns) noexcept;
  bool partner_has_ended() const noexcept;
  bool all_have_ended() const noexcept;
  void bundle() noexcept;

  const IntakeOptions options_;
  const bool lossless_;
  std::atomic<bool> closed_{false};
  Wake arrived_;
  std::vector<std::unique_ptr<Lane>> lanes_;
  // Several cameras only:
  std::unique_ptr<Bundler> bundler_;
  Losses set_losses_;
  HandOver<FrameSet> sets_;
  std::thread bundling_;
};

}  // namespace rptv
