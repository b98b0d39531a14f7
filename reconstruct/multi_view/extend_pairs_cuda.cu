// SPDX-License-Identifier: MIT
// A thread a pair and view asks; a thread a pair writes the tuples.
#include "reconstruct/multi_view/extend_pairs_cuda.hpp"

#include "reconstruct/cuda_bin_sort.hpp"
#include "reconstruct/multi_view/asked_place_kernel.hpp"

namespace rptv {

namespace {

// A detection's cell.
struct CellBinOf {
  CudaSeen seen;
  CellOf cell_of;
  __device__ std::uint32_t operator()(std::uint32_t i) const {
    return seen.u[i] == seen.u[i] ? cell_of(seen.u[i], seen.v[i]) : kNoBin;
  }
};

// Where a pair says that a view sees the particle.
struct Question {
  AskedPlace at;
  Point3 place_mm;
};

__device__ Question question_of(const CudaViews& views, const CudaPairs& pairs, const CudaExtension& extension,
                                std::uint32_t pair, std::uint32_t view) {
  const CudaViewGeometry &first = views.geometry[extension.first], &second = views.geometry[extension.second];
  const CudaViewGeometry& asked = views.geometry[view];
  Sight sight;
  sight_along(views.ray[std::size_t{extension.first} * views.max_detections + pairs.first[pair]], first.axes,
              sight.from_mm, sight.along);
  const double t = pairs.depth_mm[pair];
  const double wrong_mm = depth_error_mm(across_px(extension.tolerance_px, second.px_per_mm, first.px_per_mm),
                                         EpipolarLine(second.pinhole, sight).place(t));
  return {AskedPlace(EpipolarLine(asked.pinhole, sight).place(t), extension.tolerance_px,
                     across_px(extension.tolerance_px, asked.px_per_mm, first.px_per_mm), wrong_mm),
          sight.from_mm + t * sight.along};
}

// visit(detection) for the view's unsettled ones in the question's box.
template <class Visit>
__device__ void each_hit(const CudaViews& views, std::uint32_t view, const Question& question, const Visit& visit) {
  const CudaViewGeometry& geometry = views.geometry[view];
  const CudaSeen seen = views.seen(view, 0);
  const CudaBins cells = views.cells(view);
  const bool wanders = geometry.wander_px > kNoWander_px;
  const AskedPlace& at = question.at;
  const double reach_u = at.reach_u() + geometry.wander_px, reach_v = at.reach_v() + geometry.wander_px;
  const std::uint32_t left = geometry.cell.column(at.u - reach_u), right = geometry.cell.column(at.u + reach_u);
  const std::uint32_t last = geometry.cell.row(at.v + reach_v);
  for (std::uint32_t row = geometry.cell.row(at.v - reach_v); row <= last; ++row) {
    const std::uint32_t until = cells.start[row * CellOf::kAcross + right + 1];
    for (std::uint32_t k = cells.start[row * CellOf::kAcross + left]; k < until; ++k) {
      const std::uint32_t detection = cells.entry[k];
      double off_u = at.u - seen.u[detection], off_v = at.v - seen.v[detection];
      if (!(std::abs(off_u) <= reach_u && std::abs(off_v) <= reach_v) || seen.settled[detection] != 0) continue;
      if (wanders) {
        const auto miss = miss_px(seen.ray[detection], geometry.axes, question.place_mm);
        off_u = miss[0], off_v = miss[1];
      }
      if (at.holds(off_u, off_v)) visit(detection);
    }
  }
}

__global__ void ask_views(CudaViews views, CudaPairs pairs, CudaExtension extension, CudaHits out,
                          CudaMatchCounts* counts) {
  const std::uint32_t count = min(*pairs.count, pairs.capacity), later = views.views - extension.second - 1;
  for (std::uint32_t item = cuda_item(); item < count * later; item += cuda_stride()) {
    const std::uint32_t pair = item % count, view = extension.second + 1 + item / count;
    std::uint32_t hits = 0;
    each_hit(views, view, question_of(views, pairs, extension, pair, view), [&](std::uint32_t detection) {
      if (hits < kMostHits)
        out.hit[(std::size_t{kMostHits} * view + hits++) * pairs.capacity + pair] = detection;
      else
        atomicAdd(&counts->refused_hits, 1ULL);
    });
    out.hits[std::size_t{view} * pairs.capacity + pair] = hits;
  }
}

__global__ void write_tuples(CudaViews views, CudaPairs pairs, CudaExtension extension, CudaHits hits,
                             CudaTuples tuples, CudaMatchCounts* counts) {
  const std::uint32_t count = min(*pairs.count, pairs.capacity);
  for (std::uint32_t pair = cuda_item(); pair < count; pair += cuda_stride()) {
    std::uint32_t seen = 2;
    unsigned long long all = 1;
    for (std::uint32_t v = extension.second + 1; v < views.views; ++v) {
      const std::uint32_t of_view = hits.hits[std::size_t{v} * pairs.capacity + pair];
      seen += of_view > 0, all *= of_view > 0 ? of_view : 1;
    }
    if (seen < extension.min_views) continue;
    const std::uint32_t written = static_cast<std::uint32_t>(all < kMostOfAPair ? all : kMostOfAPair);
    if (written < all) atomicAdd(&counts->refused_tuples, all - written);
    const std::uint32_t first = atomicAdd(tuples.count, written);
    for (std::uint32_t number = 0; number < written && first + number < tuples.capacity; ++number) {
      std::uint32_t digits = number;
      for (std::uint32_t v = 0; v < views.views; ++v) {
        std::uint32_t detection = kNoDetection;
        if (v == extension.first) detection = pairs.first[pair];
        if (v == extension.second) detection = pairs.second[pair];
        const std::uint32_t of_view = v > extension.second ? hits.hits[std::size_t{v} * pairs.capacity + pair] : 0;
        if (of_view > 0) {
          detection = hits.hit[(std::size_t{kMostHits} * v + digits % of_view) * pairs.capacity + pair];
          digits /= of_view;
        }
        tuples.detection[std::size_t{v} * tuples.capacity + first + number] = detection;
      }
    }
  }
}

}  // namespace

bool sort_into_cells_cuda(const CudaViews& views, std::uint32_t view, std::uint32_t count, const CellOf& cell_of,
                          void* stream, unsigned threads_per_block) noexcept {
  return sort_into_bins(CellBinOf{views.seen(view, count), cell_of}, count, CellOf::kCells, views.cells(view), stream,
                        threads_per_block);
}

bool extend_pairs_cuda(const CudaViews& views, const CudaPairs& pairs, const CudaExtension& extension,
                       const CudaHits& scratch, const CudaTuples& tuples, CudaMatchCounts* counts, void* stream,
                       unsigned threads_per_block) noexcept {
  const std::size_t later = views.views - extension.second - 1;
  return launch(ask_views, pairs.capacity * later, threads_per_block, stream, views, pairs, extension, scratch,
                counts) &&
         launch(write_tuples, pairs.capacity, threads_per_block, stream, views, pairs, extension, scratch, tuples,
                counts);
}

}  // namespace rptv
