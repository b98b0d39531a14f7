// SPDX-License-Identifier: MIT
// The DLT with four tuples in a vector.
#if defined(__x86_64__)
#define RPTV_DLT_TARGET [[gnu::target("avx2")]]
#endif
#include "reconstruct/multi_view/dlt_loops.hpp"

#if defined(__x86_64__)
namespace rptv {

namespace {

using Double4 [[gnu::vector_size(32)]] = double;

}  // namespace

RPTV_DLT_TARGET void solve_dlt_avx2(std::span<const DltRow> rows, DltSolutions& out) noexcept {
  solve_dlt_lanes<Double4>(rows, out);
}

}  // namespace rptv
#endif
