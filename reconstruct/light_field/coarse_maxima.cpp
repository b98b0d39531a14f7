// SPDX-License-Identifier: MIT
// Smoothing and comparison row by row, in loops that the compiler turns into vector code for each instruction set.
#include "reconstruct/light_field/coarse_maxima.hpp"

#include <algorithm>

#include "reconstruct/parallel.hpp"

namespace rptv {

namespace {

constexpr std::size_t kBlock = 64;

#define RPTV_INLINE [[gnu::always_inline]] inline

RPTV_INLINE std::uint16_t u16(int value) noexcept { return static_cast<std::uint16_t>(value); }
RPTV_INLINE std::uint16_t higher(std::uint16_t a, std::uint16_t b) noexcept { return a > b ? a : b; }
RPTV_INLINE std::uint16_t clamped(std::uint16_t count) noexcept {
  return count < kMostSmoothable ? count : kMostSmoothable;
}

// Weights 1-2-1 along y; null: a row of the border, which counts rays that have left the volume.
RPTV_INLINE void smooth_column(std::size_t size, const std::uint16_t* above, const std::uint16_t* __restrict row,
                               const std::uint16_t* below, std::uint16_t* __restrict out) noexcept {
  for (std::size_t x = 0; x < size; ++x) out[x] = u16(2 * clamped(row[x]));
  for (const std::uint16_t* __restrict other : {above, below})
    for (std::size_t x = 0; other != nullptr && x < size; ++x) out[x] = u16(out[x] + clamped(other[x]));
}

RPTV_INLINE void smooth_row(std::size_t size, const std::uint16_t* __restrict row,
                            std::uint16_t* __restrict out) noexcept {
  for (std::size_t x = 1; x <= size; ++x) out[x] = u16(row[x - 1] + 2 * row[x] + row[x + 1]);
}

// The highest of three rows, then of three columns.
RPTV_INLINE void highest_row(std::size_t size, const std::uint16_t* __restrict row, std::size_t stride,
                             std::uint16_t* __restrict three, std::uint16_t* __restrict out) noexcept {
  for (std::size_t x = 0; x < size + 2; ++x) three[x] = higher(higher(row[x - stride], row[x]), row[x + stride]);
  for (std::size_t x = 1; x <= size; ++x) out[x] = higher(higher(three[x - 1], three[x]), three[x + 1]);
}

// Of each block: is any voxel the highest of its neighbours, those on the planes before and after (null: none)
// included?
RPTV_INLINE void find_peaks(const std::uint16_t* smooth, const std::uint16_t* highest, const std::uint16_t* before,
                            const std::uint16_t* after, std::size_t size, std::uint16_t bound,
                            std::uint8_t* peaks) noexcept {
  for (std::size_t first = 0; first < size; first += kBlock) {
    const std::size_t last = size - first < kBlock ? size : first + kBlock;
    std::uint16_t any = 0;
    for (std::size_t i = first; i < last; ++i) {
      const std::uint16_t lower = before == nullptr ? u16(0) : before[i], upper = after == nullptr ? u16(0) : after[i];
      any |= u16((smooth[i] == highest[i]) & (smooth[i] >= bound) & (smooth[i] > lower) & (smooth[i] >= upper));
    }
    *peaks++ = any != 0;
  }
}

RPTV_INLINE void smooth_plane(const VoxelGrid& grid, const std::uint16_t* counts, const CoarsePlane& plane) noexcept {
  const auto size = static_cast<std::size_t>(grid.size_x), stride = size + 2;
  const auto rows = static_cast<std::size_t>(grid.size_y);
  std::uint16_t* scratch = plane.scratch;  // a row with a zero at either end
  for (std::size_t y = 1; y <= rows; ++y) {
    const std::uint16_t* row = counts + y * stride + 1;
    smooth_column(size, y > 1 ? row - stride : nullptr, row, y < rows ? row + stride : nullptr, scratch + 1);
    smooth_row(size, scratch, plane.smooth + y * stride);
  }
  for (std::size_t y = 1; y <= rows; ++y)  // the border of `smooth` is zero
    highest_row(size, plane.smooth + y * stride, stride, plane.three, plane.highest + y * stride);
}

// The two functions for one instruction set.
#define RPTV_LOOPS(SET, TARGET)                                                                                        \
  TARGET void smooth_plane_##SET(const VoxelGrid& grid, const std::uint16_t* counts,                                   \
                                 const CoarsePlane& plane) noexcept {                                                  \
    smooth_plane(grid, counts, plane);                                                                                 \
  }                                                                                                                    \
  TARGET void find_peaks_##SET(const std::uint16_t* smooth, const std::uint16_t* highest, const std::uint16_t* before, \
                               const std::uint16_t* after, std::size_t size, std::uint16_t bound,                      \
                               std::uint8_t* peaks) noexcept {                                                         \
    find_peaks(smooth, highest, before, after, size, bound, peaks);                                                    \
  }                                                                                                                    \
  constexpr CoarseMaximaLoops k_##SET{smooth_plane_##SET, find_peaks_##SET};

RPTV_LOOPS(portable, )
#if defined(__x86_64__)
RPTV_LOOPS(avx2, [[gnu::target("avx2")]])
#if defined(__clang__)  // knows no preferred width here
RPTV_LOOPS(avx512, [[gnu::target("avx512f,avx512bw,avx512vl")]])
#else
RPTV_LOOPS(avx512, [[gnu::target("avx512f,avx512bw,avx512vl,prefer-vector-width=512")]])
#endif
#endif

const CoarseMaximaLoops& loops_for(InstructionSet set) noexcept {
#if defined(__x86_64__)
  if (set == InstructionSet::avx512) return k_avx512;
  if (set == InstructionSet::avx2) return k_avx2;
#endif
  static_cast<void>(set);
  return k_portable;
}

}  // namespace

CoarseMaxima::CoarseMaxima(const VoxelGrid& grid, std::size_t threads, InstructionSet set)
    : grid_(grid),
      plane_size_(static_cast<std::size_t>(grid.plane_size())),
      plane_blocks_((plane_size_ + kBlock - 1) / kBlock),
      loops_(loops_for(set)),
      smooth_(plane_size_ * static_cast<std::size_t>(grid.planes)),
      highest_(smooth_.size()),
      peaks_(plane_blocks_ * static_cast<std::size_t>(grid.planes)),
      rows_(std::max<std::size_t>(threads, 1),
            std::vector<std::uint16_t>(2 * static_cast<std::size_t>(grid.stride()))) {}

bool CoarseMaxima::is_maximum(std::size_t plane, std::size_t index) const noexcept {
  const auto size = plane_size_, stride = static_cast<std::size_t>(grid_.stride());
  const std::size_t at = plane * size + index;
  const std::uint16_t self = smooth_[at];
  if (plane > 0 && highest_[at - size] >= self) return false;
  if (plane + 1 < static_cast<std::size_t>(grid_.planes) && highest_[at + size] > self) return false;
  return smooth_[at - 1] != self && smooth_[at - stride - 1] != self && smooth_[at - stride] != self &&
         smooth_[at - stride + 1] != self;
}

// Vertex of the parabola through the highest counts near a maximum on its own and the two neighbouring planes.
double CoarseMaxima::depth_offset(std::size_t plane, std::size_t index) const noexcept {
  if (plane == 0 || plane + 1 == static_cast<std::size_t>(grid_.planes)) return 0;
  const std::uint16_t* here = &highest_[plane * plane_size_ + index];
  return depth_offset_of(here[-static_cast<std::ptrdiff_t>(plane_size_)], *here, here[plane_size_]);
}

std::size_t CoarseMaxima::find(const RayCounter& counter, std::uint16_t least,
                               std::vector<Candidate>& candidates) noexcept {
  const auto planes = static_cast<std::size_t>(grid_.planes), stride = static_cast<std::size_t>(grid_.stride());
  const std::uint16_t bound = smoothed_bound(least);
  parallel_for(planes, rows_.size(), [&](std::size_t z, std::size_t thread) {
    std::uint16_t* rows = rows_[thread].data();
    loops_.smooth_plane(grid_, counter.plane(static_cast<std::int32_t>(z)).data(),
                        {&smooth_[z * plane_size_], &highest_[z * plane_size_], rows, rows + stride});
  });
  parallel_for(planes, rows_.size(), [&](std::size_t z, std::size_t) {
    const std::uint16_t* highest = &highest_[z * plane_size_];
    loops_.find_peaks(&smooth_[z * plane_size_], highest, z > 0 ? highest - plane_size_ : nullptr,
                      z + 1 < planes ? highest + plane_size_ : nullptr, plane_size_, bound, &peaks_[z * plane_blocks_]);
  });
  std::size_t refused = 0;
  for (std::size_t z = 0; z < planes; ++z)
    for (std::size_t block = 0; block < plane_blocks_; ++block) {
      if (peaks_[z * plane_blocks_ + block] == 0) continue;
      for (std::size_t i = block * kBlock; i < std::min((block + 1) * kBlock, plane_size_); ++i) {
        const std::uint16_t smooth = smooth_[z * plane_size_ + i];
        if (smooth < bound || smooth != highest_[z * plane_size_ + i] || !is_maximum(z, i)) continue;
        const auto x = static_cast<double>(i % stride), y = static_cast<double>(i / stride);
        const Candidate found = candidate_at(counter, x, y, static_cast<double>(z) + depth_offset(z, i));
        if (found.rays < least) continue;
        if (candidates.size() == candidates.capacity())
          ++refused;
        else
          candidates.push_back(found);
      }
    }
  return refused;
}

}  // namespace rptv
