// SPDX-License-Identifier: MIT
// The sources' side of the front door: slots out, frames in, every index accounted for.
#include "acquisition/intake.hpp"

#include <pthread.h>

#include <string>
#include <utility>

#include "acquisition/lane.hpp"
#include "core/error.hpp"

namespace rptv {
namespace {

constexpr std::int64_t kPatienceNs = 100'000'000;

// Frames of a camera outside its bundler queue while sets flow: two in its lane, one in its thread's hand, one in a set
// that waits, one in the set that is being used.
constexpr std::size_t kLosslessLaneDepth = 2;
constexpr std::size_t kFramesOutsideBundler = 5;

const IntakeOptions& checked(const IntakeOptions& options, std::size_t cameras) {
  if (cameras == 0 || cameras > kMaxCameras)
    throw Error(ExitCode::configuration, "the source has " + std::to_string(cameras) + " cameras; 1 to " +
                                             std::to_string(kMaxCameras) + " can be used");
  const std::size_t needed = options.bundle_patience_frames + 2 + kFramesOutsideBundler;
  if (cameras > 1 && options.pool_frames_per_camera < needed)
    throw Error(ExitCode::configuration, "pool_frames = " + std::to_string(options.pool_frames_per_camera) +
                                             " per camera is too few for bundle_patience_frames = " +
                                             std::to_string(options.bundle_patience_frames) + "; set it to " +
                                             std::to_string(needed) + " or more");
  return options;
}

// With several cameras a lane only carries frames to the bundling thread. Lossless: a short queue, so that a camera
// that is ahead is held back. Otherwise one that has room for every slot there is, so that it never overflows.
HandOverPolicy lane_policy(const IntakeOptions& options, std::size_t cameras) {
  if (cameras == 1) return options.policy;
  if (std::holds_alternative<Lossless>(options.policy)) return Lossless{kLosslessLaneDepth};
  return Bounded{options.pool_frames_per_camera};
}

}  // namespace

Intake::Lane::Lane(const CameraInfo& camera, const IntakeOptions& options, const HandOverPolicy& policy)
    : shape(camera.shape),
      pool(options.pool_frames_per_camera, camera.shape.bytes() + camera.bytes_behind_image),
      queue(policy, losses),
      depth(depth_of(policy)) {}

Intake::Intake(const std::vector<CameraInfo>& cameras, const IntakeOptions& options)
    : options_(checked(options, cameras.size())),
      lossless_(std::holds_alternative<Lossless>(options.policy)),
      sets_(options.policy, set_losses_) {
  std::vector<Losses*> losses;
  for (const CameraInfo& camera : cameras) {
    lanes_.push_back(std::make_unique<Lane>(camera, options, lane_policy(options, cameras.size())));
    losses.push_back(&lanes_.back()->losses);
  }
  if (cameras.size() == 1) return;
  const BundlerOptions bundling{.room = options.bundle_patience_frames + 2,
                                .patience = lossless_ ? BundlerOptions::kForever : options.bundle_patience_frames,
                                .bound_ns = options.bound_ns,
                                .pairing = options.pairing};
  bundler_ = std::make_unique<Bundler>(std::move(losses), bundling);
  bundling_ = std::thread([this] { bundle(); });
  pthread_setname_np(bundling_.native_handle(), "rptv-bundle");
}

Intake::~Intake() {
  close();
  sets_.close();  // frees a bundling thread that waits for a consumer that is gone
  if (bundling_.joinable()) bundling_.join();
}

std::span<std::byte> Intake::frame_memory(std::uint32_t camera) noexcept { return lanes_[camera]->pool.memory(); }

FrameLease Intake::claim(std::uint32_t camera) noexcept {
  Lane& lane = *lanes_[camera];
  while (!closed_.load(std::memory_order_seq_cst)) {
    const std::uint32_t seen = lane.pool.prepare_to_wait();
    FrameLease lease = lane.pool.claim();
    if (lease) return lease;
    if (!lossless_) {
      lane.losses.count(LossCause::pool_empty);
      ++lane.excused;
      break;
    }
    lane.pool.wait_for_slot(seen, kPatienceNs);
  }
  return {};
}

void Intake::deliver(Frame&& frame) noexcept {
  Frame mine = std::move(frame);  // whatever becomes of it, the source keeps no lease
  Lane& lane = *lanes_[mine.info.camera];
  lane.delivered.fetch_add(1, std::memory_order_relaxed);
  if (!accept(lane, mine)) return;
  FrameInfo& info = mine.info;
  if ((info.clock == ClockId::device || info.clock == ClockId::ptp) && info.arrival_ns > 0)
    info.exposure_end_host_ns = lane.clock.map(info.exposure_end_ns, info.arrival_ns);
  lane.queued.fetch_add(1, std::memory_order_seq_cst);
  // Before a push that will wait: the bundling thread may have to give something up to make room.
  if (bundler_ && lossless_ && lane.queue.waiting() >= lane.depth) arrived_.notify();
  lane.queue.push(std::move(mine));
  if (bundler_) arrived_.notify();
}

// Checks index and content; counts what is missing before this frame, and the frame itself when it is refused.
bool Intake::accept(Lane& lane, const Frame& frame) noexcept {
  const std::uint64_t index = frame.info.index;
  if (lane.started && index <= lane.last_index) {
    lane.losses.count(index == lane.last_index ? LossCause::source_duplicate : LossCause::set_stale);
    return false;
  }
  const std::uint64_t skipped = lane.started ? index - lane.last_index - 1 : 0;
  if (skipped > lane.excused) lane.losses.count(LossCause::source_gap, skipped - lane.excused);
  lane.started = true;
  lane.last_index = index;
  lane.excused = 0;
  if (frame.info.torn || !frame.lease || frame.shape != lane.shape) {
    lane.losses.count(LossCause::source_torn);
    return false;
  }
  return true;
}

void Intake::lose(std::uint32_t camera, LossCause cause, std::uint64_t count) noexcept {
  Lane& lane = *lanes_[camera];
  lane.losses.count(cause, count);
  if (cause != LossCause::source_duplicate) lane.excused += count;  // the jump of the index that follows is explained
}

void Intake::close() noexcept {
  closed_.store(true, std::memory_order_seq_cst);
  for (auto& lane : lanes_) {
    lane->queue.close();
    lane->pool.wake_waiters();
  }
  arrived_.notify();
}

const Losses& Intake::losses(std::uint32_t camera) const noexcept { return lanes_[camera]->losses; }

ClockMapping Intake::clock_mapping(std::uint32_t camera) const noexcept { return lanes_[camera]->clock.mapping(); }

std::uint64_t Intake::delivered(std::uint32_t camera) const noexcept {
  return lanes_[camera]->delivered.load(std::memory_order_relaxed);
}

std::size_t Intake::free_slots(std::uint32_t camera) const noexcept { return lanes_[camera]->pool.free_slots(); }

Taken Intake::next(FrameSet& set, std::int64_t timeout_ns) noexcept {
  set.reset();
  if (bundler_) return sets_.pop(set, timeout_ns);
  const Taken taken = lanes_[0]->queue.pop(set.frames[0], timeout_ns);
  set.cameras = taken == Taken::value ? 1 : 0;
  return taken;
}

}  // namespace rptv
