// SPDX-License-Identifier: MIT
// The join of the cameras' queues at their heads.
#include "acquisition/bundler.hpp"

#include <algorithm>
#include <utility>

namespace rptv {

Bundler::Bundler(std::vector<Losses*> losses, const BundlerOptions& options)
    : options_(options),
      lanes_(losses.size()),
      skews_(std::make_unique<SkewMeter[]>(losses.size())),
      pairing_(options.pairing) {
  for (std::size_t camera = 0; camera < lanes_.size(); ++camera) {
    lanes_[camera].frames = std::vector<Waiting>(options.room);
    lanes_[camera].losses = losses[camera];
  }
}

void Bundler::offer(Frame&& frame, std::int64_t now_ns) noexcept {
  Lane& lane = lanes_[frame.info.camera];
  const bool stale = frame.info.index < horizon_;
  if (stale || !pairing_.is_timed(frame.info)) {
    lane.losses->count(stale ? LossCause::set_stale : LossCause::set_untimed);
    frame.lease.reset();
    return;
  }
  lane.frames[(lane.first + lane.held) % options_.room] = {std::move(frame), now_ns};
  ++lane.held;
}

bool Bundler::take(FrameSet& set, std::int64_t now_ns) noexcept {
  while (true) {
    const Pairing::Passed passed = pairing_.passed(heads());
    if (passed.cameras != 0) {
      drop(passed);
    } else if (is_complete()) {
      fill(set);
      return true;
    } else if (!has_waited_enough(now_ns) || !give_up_oldest()) {
      return false;
    }
  }
}

bool Bundler::give_up_oldest() noexcept {
  Pairing::Passed all;
  for (std::size_t camera = 0; camera < lanes_.size(); ++camera)
    if (!lacks(camera)) all.cameras |= 1U << camera;
  drop(all);
  pairing_.forget();
  return all.cameras != 0;
}

std::int64_t Bundler::deadline_ns() const noexcept {
  std::int64_t deadline_ns = BundlerOptions::kNoBound;
  if (options_.bound_ns == BundlerOptions::kNoBound) return deadline_ns;
  for (const Lane& lane : lanes_)
    if (lane.held != 0) deadline_ns = std::min(deadline_ns, head(lane).since_ns + options_.bound_ns);
  return deadline_ns;
}

Pairing::Heads Bundler::heads() const noexcept {
  Pairing::Heads heads{};
  for (std::size_t camera = 0; camera < lanes_.size(); ++camera)
    if (!lacks(camera)) heads[camera] = &head(lanes_[camera]).frame.info;
  return heads;
}

bool Bundler::is_complete() const noexcept {
  return std::all_of(lanes_.begin(), lanes_.end(), [](const Lane& lane) { return lane.held != 0; });
}

bool Bundler::has_waited_enough(std::int64_t now_ns) const noexcept {
  if (now_ns >= deadline_ns()) return true;
  return std::any_of(lanes_.begin(), lanes_.end(),
                     [&](const Lane& lane) { return lane.held != 0 && lane.held - 1 > options_.patience; });
}

Frame Bundler::pop(Lane& lane) noexcept {
  Frame frame = std::move(lane.frames[lane.first].frame);
  lane.first = (lane.first + 1) % options_.room;
  --lane.held;
  if (pairing_.by_index_alone()) horizon_ = std::max(horizon_, frame.info.index + 1);
  return frame;
}

void Bundler::drop(const Pairing::Passed& passed) noexcept {
  for (std::size_t camera = 0; camera < lanes_.size(); ++camera) {
    if ((passed.cameras >> camera & 1U) == 0) continue;
    pop(lanes_[camera]);
    lanes_[camera].losses->count(passed.cause);
  }
}

void Bundler::fill(FrameSet& set) noexcept {
  pairing_.align(heads());
  set.cameras = static_cast<std::uint32_t>(lanes_.size());
  for (std::size_t camera = 0; camera < lanes_.size(); ++camera) {
    Frame& frame = set.frames[camera] = pop(lanes_[camera]);
    frame.info.index = set.info().index;
    skews_[camera].record(pairing_.time_ns(frame.info) - pairing_.time_ns(set.info()));
  }
}

}  // namespace rptv
