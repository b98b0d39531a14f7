// SPDX-License-Identifier: MIT
// Running sums on the device: where the items of each part begin.
#pragma once

#include <cstddef>
#include <cstdint>

namespace rptv {

/// Items that a warp compacts, 32 at a time, and how many such runs there are: compact_cuda() has a number for each.
constexpr std::uint32_t kCompactRun = 1024;
inline std::size_t compact_runs(std::size_t items) { return (items + kCompactRun - 1) / kCompactRun; }

/// Queues on `stream` (a cudaStream_t): values[i] becomes the sum of those before it, and *total that of all. There are
/// `size` of them, or min(*live, size) where `live` is not null; those beyond are left alone. `values`, `live` and
/// `total` are on the device. One block works; `threads_per_block`: a multiple of 32. False when the runtime refuses.
bool exclusive_scan_cuda(std::uint32_t* values, std::size_t size, const std::uint32_t* live, std::uint32_t* total,
                         void* stream, unsigned threads_per_block = 1024) noexcept;

}  // namespace rptv
