// SPDX-License-Identifier: MIT
// Lays tuples out for the DLT, and projects its points back.
#include "reconstruct/multi_view/tuple_solver.hpp"

#include <cmath>

#include "calibration/space_algebra.hpp"

namespace rptv {

double TupleSolver::scale_mm(const Volume& volume) noexcept { return 8 * norm(volume.to - volume.centre()); }

void TupleSolver::push(const ViewTuple& tuple) noexcept {
  static constexpr DltRowPair kNoRows{};
  for (std::size_t v = 0; v < views_.size(); ++v)
    put_rows(tuple.detection[v] == kUnseen ? kNoRows : views_[v].rows(tuple.detection[v]), waiting_, &rows_[2 * v]);
  tuple_[waiting_++] = tuple;
}

double TupleSolver::judge(ViewMatch& match, std::size_t& worst_view) const noexcept {
  double worst = 0;
  for (std::size_t v = 0; v < views_.size(); ++v) {
    if (match.tuple.detection[v] == kUnseen) continue;
    const auto miss = miss_px(views_[v].ray(match.tuple.detection[v]), views_[v].rays().axes(), match.at_mm);
    const double square = miss[0] * miss[0] + miss[1] * miss[1];
    match.square_px2 += square;
    if (square > worst) worst = square, worst_view = v;
  }
  return std::isfinite(match.square_px2) ? std::sqrt(worst) : HUGE_VAL;
}

}  // namespace rptv
