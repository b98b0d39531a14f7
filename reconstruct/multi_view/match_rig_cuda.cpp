// SPDX-License-Identifier: MIT
// Puts a rig's views on the device.
#include <fmt/format.h>

#include "core/error.hpp"
#include "reconstruct/multi_view/match_stream_cuda.hpp"
#include "reconstruct/multi_view/tuple_solver.hpp"

namespace rptv {

namespace {

CudaViewGeometry geometry_of(const ViewRays& view) {
  const auto& [left, top, right, bottom] = view.pinhole_range();
  const double across = CellOf::kAcross;
  return {view.axes(),
          view.pinhole(),
          view.px_per_mm(),
          view.wander_px(),
          {left, top, across / (right - left), across / (bottom - top)}};
}

}  // namespace

MatchRig::MatchRig(std::span<const ViewRays> views, const Volume& volume, const CorrespondenceOptions& options,
                   unsigned threads_per_block)
    : views_(views),
      options_(options),
      device_(views.size()),
      judging_{volume.to - volume.centre(), TupleSolver::scale_mm(volume), options.tolerance_px,
               static_cast<std::uint32_t>(options.min_views)},
      threads_per_block_(threads_per_block) {
  for (std::size_t second = 0; second < views.size(); ++second) {
    geometry_.push_back(geometry_of(views[second]));
    for (std::size_t first = 0; first < second; ++first) {
      lines_[first][second] = PencilOfLines(views[first], views[second]);
      if (!lines_[first][second].usable)
        throw Error(ExitCode::unavailable,
                    fmt::format("CUDA: camera {} is in the image of camera {}, or near it, which this backend does not "
                                "do; take reconstruction.backend = \"cpu\"",
                                first, second));
    }
  }
  CudaStream stream;
  if (!stream.upload(device_.data(), geometry_.data(), geometry_.size() * sizeof(CudaViewGeometry)) ||
      !stream.synchronize())
    throw Error(ExitCode::unavailable,
                fmt::format("CUDA: the rig does not reach the device: {}; take reconstruction.backend = \"cpu\"",
                            take_cuda_error()));
}

CudaPairSearch MatchRig::search(const CudaViews& views, std::size_t first, std::size_t second,
                                std::span<const std::uint32_t> counts) const noexcept {
  const CudaViewGeometry &from = geometry_[first], &to = geometry_[second];
  const auto seen = [&](std::size_t view) { return views.seen(static_cast<std::uint32_t>(view), counts[view]); };
  return {seen(first),      seen(second),
          from.axes,        to.axes,
          to.pinhole,       lines_[first][second],
          judging_.half_mm, across_px(options_.tolerance_px, to.px_per_mm, from.px_per_mm),
          to.wander_px};
}

}  // namespace rptv
