// SPDX-License-Identifier: MIT
// Tuples of views in, points and reprojection errors out: gathers eight tuples, solves them together, and judges them.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "reconstruct/multi_view/dlt.hpp"
#include "reconstruct/multi_view/seen_view.hpp"
#include "reconstruct/multi_view/view_match.hpp"

namespace rptv {

/// Eight tuples wait at most. One thread at a time; allocates nothing.
class TupleSolver {
 public:
  /// Coordinates are divided by it: eight times the volume's half diagonal, so that s is within 1 % of a px² sum's
  /// root.
  static double scale_mm(const Volume& volume) noexcept;

  TupleSolver(std::span<const SeenView> views, double scale_mm, InstructionSet set) noexcept
      : views_(views), scale_mm_(scale_mm), dlt_(set) {}

  void clear() noexcept { waiting_ = 0; }
  bool full() const noexcept { return waiting_ == kDltLanes; }
  bool empty() const noexcept { return waiting_ == 0; }
  void push(const ViewTuple& tuple) noexcept;

  /// visit(match, view of the largest error, that error in px) for each tuple that waits; then none does. visit() may
  /// push again.
  template <class Visit>
  void solve(const Visit& visit) noexcept {
    const std::size_t count = waiting_;
    DltSolutions found;
    dlt_(std::span<const DltRow>(rows_.data(), 2 * views_.size()), found);
    const auto tuples = tuple_;
    waiting_ = 0;
    for (std::size_t lane = 0; lane < count; ++lane) {
      ViewMatch match{tuples[lane],
                      {scale_mm_ * found.x[lane], scale_mm_ * found.y[lane], scale_mm_ * found.z[lane]},
                      0,
                      found.s[lane]};
      std::size_t worst = 0;
      const double worst_px = judge(match, worst);
      visit(match, worst, worst_px);
    }
  }

 private:
  double judge(ViewMatch& match, std::size_t& worst_view) const noexcept;

  std::span<const SeenView> views_;
  double scale_mm_;
  Dlt dlt_;
  std::size_t waiting_ = 0;
  std::array<ViewTuple, kDltLanes> tuple_;
  std::array<DltRow, 2 * kMaxViews> rows_{};
};

}  // namespace rptv
