// SPDX-License-Identifier: MIT
// One frame set after the other through a stream of its own.
#include "reconstruct/multi_view/match_cuda.hpp"

#include "reconstruct/multi_view/match_stream_cuda.hpp"

namespace rptv {

namespace {

class MatchCuda final : public MatchDevice {
 public:
  explicit MatchCuda(const MatchDevicePlan& plan)
      : rig_(plan.rays, plan.volume, matching_of(plan.settings, 1)), stream_(rig_) {}

  bool match(std::span<const Detections> seen, std::span<const ViewMatch>& matches,
             CorrespondenceCounts& counts) noexcept override {
    stream_.submit(seen);
    matches = stream_.collect();
    const MatchStreamCounts& n = stream_.counts();
    counts.unusable_detections = n.unusable_detections;
    counts.refused_hits = n.refused_hits;
    counts.refused_matches = n.refused_matches + n.refused_tuples + n.refused_pairs;
    counts.rays = n.rays, counts.pairs = n.pairs;
    return n.failed == 0;
  }
  std::span<const SeenView> views() const noexcept override { return stream_.views(); }

 private:
  const MatchRig rig_;
  MatchStream stream_;
};

}  // namespace

std::unique_ptr<MatchDevice> make_match_cuda(const MatchDevicePlan& plan) { return std::make_unique<MatchCuda>(plan); }

}  // namespace rptv
