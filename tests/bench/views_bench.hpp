// SPDX-License-Identifier: MIT
// The tables that rptv_bench_views prints.
#pragma once

#include <ostream>

namespace rptv::bench {

void bench_dlt(std::ostream& out, int rounds);
void bench_matching(std::ostream& out, int rounds);
void bench_chain(std::ostream& out, int rounds);

}  // namespace rptv::bench
