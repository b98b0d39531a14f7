// SPDX-License-Identifier: MIT
// One thread gathers a tuple's rows and solves them in a fixed order.
#include "reconstruct/multi_view/dlt_cuda.hpp"

#include "reconstruct/cuda_launch.hpp"
#include "reconstruct/multi_view/dlt_point_kernel.hpp"

namespace rptv {

namespace {

__global__ void solve_tuples(CudaDltRows rows, CudaTuples tuples, CudaPoints out) {
  const std::uint32_t count = min(*tuples.count, tuples.capacity);
  for (std::uint32_t i = cuda_item(); i < count; i += cuda_stride()) {
    DltNormal<double> normal;
    for (std::uint32_t v = 0; v < tuples.views; ++v) {
      const std::uint32_t detection = tuples.detection[std::size_t{v} * tuples.capacity + i];
      if (detection == kNoDetection) continue;
      const double* pair = rows.value + 8 * (std::size_t{v} * rows.max_detections + detection);
      add_row(normal, pair[0], pair[1], pair[2], pair[3]);
      add_row(normal, pair[4], pair[5], pair[6], pair[7]);
    }
    DltPoint<double> point;
    if (solve_normal(normal, point)) solve_normal_slowly(normal, point);
    out.x[i] = point.x, out.y[i] = point.y, out.z[i] = point.z, out.s[i] = sqrt(point.square);
  }
}

}  // namespace

bool solve_dlt_cuda(const CudaDltRows& rows, const CudaTuples& tuples, const CudaPoints& out, void* stream,
                    unsigned threads_per_block) noexcept {
  return launch(solve_tuples, tuples.capacity, threads_per_block, stream, rows, tuples, out);
}

}  // namespace rptv
