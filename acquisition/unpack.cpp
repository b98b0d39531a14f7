// SPDX-License-Identifier: MIT
// The layouts of packed pixels, the plain loops over them, and the choice of the fast ones.
#include "acquisition/unpack.hpp"

#include "acquisition/unpack_loops.hpp"

namespace rptv {
namespace {

constexpr std::uint8_t kZero = 0x80;

/// `Bits` per pixel, one after the other, lowest first.
template <unsigned Bits>
constexpr StreamLayout stream_layout() {
  StreamLayout layout{Bits, Bits, {}, {}};
  for (unsigned i = 0; i < 8; ++i) {
    const unsigned first = i * Bits / 8, shift = i * Bits % 8;
    layout.pair[2 * i] = static_cast<std::uint8_t>(first);
    layout.pair[2 * i + 1] = static_cast<std::uint8_t>(first + 1);
    layout.factor[i] = static_cast<std::uint16_t>(1U << (16 - Bits - shift));
  }
  return layout;
}

/// Groups of `group` pixels in `bytes`: pixel i has its high byte at `high[i]`, its low bits from bit `shift[i]` of
/// byte `low`.
struct Group {
  unsigned bits, pixels, bytes, low;
  unsigned high[4];
  unsigned shift[4];
};
constexpr Group kMono12Packed{12, 2, 3, 1, {0, 2, 0, 0}, {0, 4, 0, 0}};
constexpr Group kMono10Packed{10, 2, 3, 1, {0, 2, 0, 0}, {0, 4, 0, 0}};
constexpr Group kMipi10{10, 4, 5, 4, {0, 1, 2, 3}, {0, 2, 4, 6}};
constexpr Group kMipi12{12, 2, 3, 2, {0, 1, 0, 0}, {0, 4, 0, 0}};

constexpr SplitLayout split_layout(const Group& group) {
  SplitLayout layout{group.bits, 8 / group.pixels * group.bytes, {}, {}, {}};
  for (unsigned i = 0; i < 8; ++i) {
    const unsigned base = i / group.pixels * group.bytes, member = i % group.pixels;
    layout.high[2 * i] = static_cast<std::uint8_t>(base + group.high[member]);
    layout.low[2 * i] = static_cast<std::uint8_t>(base + group.low);
    layout.high[2 * i + 1] = layout.low[2 * i + 1] = kZero;
    layout.factor[i] = static_cast<std::uint16_t>(1U << (8 - group.shift[member]));
  }
  return layout;
}

unsigned at(const std::byte* in, std::size_t byte) noexcept { return std::to_integer<unsigned>(in[byte]); }

template <unsigned Bits>
void unpack_stream(const std::byte* in, std::uint16_t* out, std::size_t pixels, InstructionSet set) noexcept {
  std::size_t i = 0;
#if defined(__x86_64__)
  static constexpr StreamLayout kLayout = stream_layout<Bits>();
  if (set != InstructionSet::portable) i = unpack_stream_avx2(kLayout, in, (pixels * Bits + 7) / 8, out, pixels);
#else
  (void)set;
#endif
  for (; i < pixels; ++i) {
    const std::size_t first = i * Bits / 8, shift = i * Bits % 8;
    out[i] = static_cast<std::uint16_t>((at(in, first) | at(in, first + 1) << 8) >> shift & ((1U << Bits) - 1));
  }
}

template <const Group& kGroup>
void unpack_split(const std::byte* in, std::uint16_t* out, std::size_t pixels, std::size_t bytes,
                  InstructionSet set) noexcept {
  std::size_t i = 0;
#if defined(__x86_64__)
  static constexpr SplitLayout kLayout = split_layout(kGroup);
  if (set != InstructionSet::portable) i = unpack_split_avx2(kLayout, in, bytes, out, pixels);
#else
  (void)bytes, (void)set;
#endif
  for (; i < pixels; ++i) {
    const std::byte* group = in + i / kGroup.pixels * kGroup.bytes;
    const std::size_t member = i % kGroup.pixels;
    const unsigned low = at(group, kGroup.low) >> kGroup.shift[member] & ((1U << (kGroup.bits - 8)) - 1);
    out[i] = static_cast<std::uint16_t>(at(group, kGroup.high[member]) << (kGroup.bits - 8) | low);
  }
}

}  // namespace

void unpack_mono12p(const std::byte* in, std::uint16_t* out, std::size_t pixels, InstructionSet set) noexcept {
  unpack_stream<12>(in, out, pixels, set);
}
void unpack_mono10p(const std::byte* in, std::uint16_t* out, std::size_t pixels, InstructionSet set) noexcept {
  unpack_stream<10>(in, out, pixels, set);
}
void unpack_mono12_packed(const std::byte* in, std::uint16_t* out, std::size_t pixels, InstructionSet set) noexcept {
  unpack_split<kMono12Packed>(in, out, pixels, bytes_of_packed(pixels), set);
}
void unpack_mono10_packed(const std::byte* in, std::uint16_t* out, std::size_t pixels, InstructionSet set) noexcept {
  unpack_split<kMono10Packed>(in, out, pixels, bytes_of_packed(pixels), set);
}
void unpack_mipi10(const std::byte* in, std::uint16_t* out, std::size_t pixels, InstructionSet set) noexcept {
  unpack_split<kMipi10>(in, out, pixels, bytes_of_mipi10(pixels), set);
}
void unpack_mipi12(const std::byte* in, std::uint16_t* out, std::size_t pixels, InstructionSet set) noexcept {
  unpack_split<kMipi12>(in, out, pixels, bytes_of_mipi12(pixels), set);
}

void extract_yuyv_luma(const std::byte* in, std::uint8_t* out, std::size_t pixels) noexcept {
  for (std::size_t i = 0; i < pixels; ++i) out[i] = std::to_integer<std::uint8_t>(in[2 * i]);
}

}  // namespace rptv
