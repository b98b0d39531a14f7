// SPDX-License-Identifier: MIT
// Measures SpscRing against the queues that Debian ships, in one run.
#pragma once

#include <iosfwd>

namespace rptv {

/// How much is measured. The defaults take some ten seconds on a quiet machine.
struct RingBenchOptions {
  int rounds = 41;            ///< alternating runs of every queue; the medians are printed
  int items = 1'000'000;      ///< values handed over per run
  int round_trips = 100'000;  ///< ping-pongs per run
  int capacity = 1024;
};

/// Prints one table per payload: ns per value handed over between two threads, ns per round trip, and each peer's time
/// over ours. Peers whose headers are not installed are left out. Two threads that spin: give it two idle cores.
void bench_ring(std::ostream& out, const RingBenchOptions& options = {});

}  // namespace rptv
