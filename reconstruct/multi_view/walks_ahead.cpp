// SPDX-License-Identifier: MIT
// Hands stretches to threads in order; all stop when their work together is done.
#include "reconstruct/multi_view/walks_ahead.hpp"

#include <algorithm>

#include "reconstruct/parallel.hpp"

namespace rptv {

WalksAhead::WalksAhead(std::span<const SeenView> views, double scale_mm, InstructionSet set, std::size_t threads,
                       std::size_t max_detections, std::size_t max_matches)
    : stretches_((max_detections + kStretch - 1) / kStretch) {
  for (std::size_t t = 0; t < threads; ++t) {
    walks_.emplace_back(views, scale_mm, set);
    found_.emplace_back(max_matches / threads + 1);
  }
}

void WalksAhead::walk(const WalkedViews& seen, std::size_t first, std::size_t second, const EpipolarPencil* pencil,
                      std::size_t rays, std::uint64_t most_work) noexcept {
  for (FoundMatches& found : found_) found.list.clear();
  std::atomic<std::uint64_t> done{0};
  parallel_for((rays + kStretch - 1) / kStretch, walks_.size(), [&](std::size_t number, std::size_t thread) {
    Stretch stretch;
    const std::uint64_t before = done.load(std::memory_order_relaxed);
    stretches_[number] = stretch;
    if (before > most_work) return;
    const auto& list = found_[thread].list;
    stretch.thread = thread, stretch.from = list.size();
    const RayStretch part{first, second, pencil, number * kStretch, std::min((number + 1) * kStretch, rays)};
    stretch.whole = walks_[thread].walk(seen, part, most_work - before, found_[thread], stretch.counts) &&
                    stretch.counts.unsearched == 0;
    stretch.until = list.size();
    stretches_[number] = stretch;
    done.fetch_add(stretch.counts.work, std::memory_order_relaxed);
  });
}

}  // namespace rptv
