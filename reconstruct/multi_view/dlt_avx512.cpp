// SPDX-License-Identifier: MIT
// The DLT with eight tuples in a vector.
#if defined(__x86_64__)
#define RPTV_DLT_TARGET [[gnu::target("avx512f,avx512vl,avx2")]]
#endif
#include "reconstruct/multi_view/dlt_loops.hpp"

#if defined(__x86_64__)
namespace rptv {

namespace {

using Double8 [[gnu::vector_size(64)]] = double;

}  // namespace

RPTV_DLT_TARGET void solve_dlt_avx512(std::span<const DltRow> rows, DltSolutions& out) noexcept {
  solve_dlt_lanes<Double8>(rows, out);
}

}  // namespace rptv
#endif
