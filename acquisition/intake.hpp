// SPDX-License-Identifier: MIT
// The pipeline's front door: gives sources their frame slots, checks what they deliver and bundles cameras into sets.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "acquisition/source.hpp"
#include "core/frame_pool.hpp"
#include "core/hand_over.hpp"
#include "core/losses.hpp"

namespace rptv {

class Bundler;

struct IntakeOptions {
  HandOverPolicy policy = Newest{};
  std::size_t pool_frames_per_camera = 16;
  /// With several cameras: how many newer frames of another camera may come before an incomplete set is given up.
  std::size_t bundle_patience_frames = 4;
};

/// FrameSink side: the source's threads. next(): one consumer thread. Counters and close(): any thread.
/// All memory is taken by the constructor.
class Intake final : public FrameSink {
 public:
  Intake(const std::vector<CameraInfo>& cameras, const IntakeOptions& options);
  ~Intake() override;

  FrameLease claim(std::uint32_t camera) noexcept override;
  void deliver(Frame&& frame) noexcept override;
  void lose(std::uint32_t camera, LossCause cause, std::uint64_t count) noexcept override;
  void end() noexcept override;

  /// Waits up to `timeout_ns` for the next complete set; frame indices of successive sets strictly increase.
  Taken next(FrameSet& set, std::int64_t timeout_ns) noexcept;
  /// Ends the stream: claim() and deliver() refuse from now on, next() drains what is in flight and then says closed.
  void close() noexcept;

  const Losses& losses(std::uint32_t camera) const noexcept { return lanes_[camera]->losses; }
  std::uint64_t delivered(std::uint32_t camera) const noexcept;
  std::size_t cameras() const noexcept { return lanes_.size(); }

 private:
  struct Lane {
    Lane(const CameraInfo& camera, const IntakeOptions& options);
    FramePool pool;
    Losses losses;
    HandOver<Frame> queue;
    bool waits;
    std::atomic<std::uint64_t> delivered{0};
    std::uint64_t next_index = 0;  // source thread only
    bool started = false;          // source thread only
  };
  std::vector<std::unique_ptr<Lane>> lanes_;
  std::unique_ptr<Bundler> bundler_;
  Wake arrived_;
};

}  // namespace rptv
