// SPDX-License-Identifier: MIT
// Runs from masks of 64 pixels; a run that goes on in the next block is joined, one that reaches the next row is cut.
#include "reconstruct/detection/lit_runs.hpp"

#include <algorithm>
#include <bit>

#include "reconstruct/detection/lit_chunks.hpp"

namespace rptv {

namespace {

class RunSink {
 public:
  RunSink(std::uint32_t width, std::vector<LitRun>& runs) noexcept : width_(width), runs_(runs) { runs_.clear(); }

  // Pixels begin … begin + length - 1, behind all that came before.
  void push(std::size_t begin, std::size_t length) noexcept {
    while (length > 0) {
      if (begin >= row_begin_ + width_) {
        row_ = begin / width_;
        row_begin_ = row_ * width_;
      }
      const std::size_t part = std::min(length, row_begin_ + width_ - begin);
      push_in_row(static_cast<std::uint32_t>(begin - row_begin_), static_cast<std::uint32_t>(part));
      begin += part, length -= part;
    }
  }
  std::size_t count() const noexcept { return count_; }

 private:
  void push_in_row(std::uint32_t first_x, std::uint32_t length) noexcept {
    const auto y = static_cast<std::uint32_t>(row_);
    const bool goes_on = count_ > 0 && y == last_y_ && first_x == last_end_;
    last_y_ = y, last_end_ = first_x + length;
    if (goes_on) {
      if (count_ == runs_.size()) runs_.back().end_x = last_end_;
      return;
    }
    if (runs_.size() < runs_.capacity()) runs_.push_back({y, first_x, last_end_});
    ++count_;
  }

  const std::size_t width_;
  std::vector<LitRun>& runs_;
  std::size_t count_ = 0, row_ = 0, row_begin_ = 0;
  std::uint32_t last_y_ = 0, last_end_ = 0;
};

template <class Lit, class Pixel>
[[gnu::always_inline]] inline std::size_t scan_runs(const Pixel* pixels, const ImageShape& shape,
                                                    const DarkLimit& limit, std::vector<LitRun>& runs) noexcept {
  RunSink sink(shape.width_px, runs);
  each_lit_chunk<Lit>(
      pixels, limit, 0, shape.pixels(),
      [&](const LitChunk& chunk, std::size_t lit) __attribute__((always_inline)) {
        for (std::size_t k = 0; k < lit; ++k) {
          std::size_t at = chunk.at[k];
          for (std::uint64_t mask = chunk.mask[k]; mask != 0;) {
            const int dark = std::countr_zero(mask);
            mask >>= dark, at += static_cast<std::size_t>(dark);
            const int length = std::countr_one(mask);
            sink.push(at, static_cast<std::size_t>(length));
            mask = length == 64 ? 0 : mask >> length, at += static_cast<std::size_t>(length);
          }
        }
      },
      [&](std::size_t i) __attribute__((always_inline)) { sink.push(i, 1); });
  return sink.count();
}

#define RPTV_RUNS(SET, TARGET, LIT)                                                                                   \
  TARGET std::size_t runs_##SET(const ImageView& image, const DarkLimit& limit, std::vector<LitRun>& runs) noexcept { \
    return image.shape.bytes_per_pixel == 1 ? scan_runs<LIT>(image.as_u8(), image.shape, limit, runs)                 \
                                            : scan_runs<LIT>(image.as_u16(), image.shape, limit, runs);               \
  }

RPTV_RUNS(portable, , LitMask)
#if defined(__x86_64__)
RPTV_RUNS(avx2, RPTV_LIT_AVX2, LitMaskAvx2)
RPTV_RUNS(avx512, RPTV_LIT_AVX512, LitMaskAvx512)
#endif

}  // namespace

std::size_t find_lit_runs(const ImageView& image, const DarkLimit& limit, std::vector<LitRun>& runs,
                          InstructionSet set) noexcept {
#if defined(__x86_64__)
  if (set == InstructionSet::avx512) return runs_avx512(image, limit, runs);
  if (set == InstructionSet::avx2) return runs_avx2(image, limit, runs);
#endif
  static_cast<void>(set);
  return runs_portable(image, limit, runs);
}

}  // namespace rptv
