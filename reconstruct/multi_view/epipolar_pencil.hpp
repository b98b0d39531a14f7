// SPDX-License-Identifier: MIT
// All epipolar lines of one view in another go through one point: detections sorted by which of those lines they are
// on.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "reconstruct/multi_view/epipolar.hpp"
#include "reconstruct/multi_view/pencil_kernel.hpp"

namespace rptv {

/// One view's detections in order of the line. Takes memory for `capacity` detections at construction.
class EpipolarPencil {
 public:
  explicit EpipolarPencil(std::size_t capacity) : entry_(capacity), bin_(capacity), start_(capacity + 2) {}

  /// `lines` (usable) and `view` must outlive the searches. Allocates nothing.
  void build(const PencilOfLines& lines, const SeenView& view) noexcept;

  /// visit(detection, t) for those within `reach_px` of the line that are in the sight's depths; t as the place along
  /// the line says. With refraction the lines need not go through the epipole: the range is of the line's ends.
  template <class Visit>
  void visit_near(const EpipolarLine& line, const Sight& sight, double reach_px, const Visit& visit) const noexcept;

 private:
  struct Entry {
    double u, v;
    std::uint32_t number;
  };
  const PencilOfLines* lines_ = nullptr;
  PencilBins bins_;
  std::vector<Entry> entry_;
  std::vector<std::uint32_t> bin_, start_;
};

template <class Visit>
void EpipolarPencil::visit_near(const EpipolarLine& line, const Sight& sight, double reach_px,
                                const Visit& visit) const noexcept {
  if (!line.in_front(sight)) return;
  const LineInPencil found(*lines_, line, sight, reach_px);
  const std::uint32_t until = start_[bins_.of(found.high) + 1];
  for (std::uint32_t i = start_[bins_.of(found.low)]; i < until;) {
    // Which are near cannot be predicted: first listed without a branch, then looked at.
    std::array<std::uint32_t, 16> near;
    std::size_t count = 0;
    for (; i < until && count < near.size(); ++i) {
      near[count] = i;
      count += found.near(entry_[i].u, entry_[i].v, reach_px) ? 1 : 0;
    }
    for (std::size_t k = 0; k < count; ++k) {
      const Entry& entry = entry_[near[k]];
      const double t = line.depth(found.major, found.major == 0 ? entry.u : entry.v);
      if (found.in_depths(t, sight)) visit(entry.number, t);
    }
  }
}

}  // namespace rptv
