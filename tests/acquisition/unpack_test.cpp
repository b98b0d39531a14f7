// SPDX-License-Identifier: MIT
// Every unpacking, with every instruction set of this machine, against packers written from the layouts' definitions.
#include "acquisition/unpack.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

namespace rptv {
namespace {

using Values = std::vector<std::uint16_t>;
using Bytes = std::vector<std::uint8_t>;

Bytes pack_stream(const Values& values, unsigned bits) {
  Bytes bytes((values.size() * bits + 7) / 8);
  for (std::size_t i = 0; i < values.size() * bits; ++i)
    if ((values[i / bits] >> i % bits & 1) != 0) bytes[i / 8] = static_cast<std::uint8_t>(bytes[i / 8] | 1 << i % 8);
  return bytes;
}
Bytes pack_mono12p(const Values& values) { return pack_stream(values, 12); }
Bytes pack_mono10p(const Values& values) { return pack_stream(values, 10); }

// GigE Vision: A's high byte; B's low bits from bit 4, A's from bit 0; B's high byte.
Bytes pack_gige(const Values& values, unsigned low_bits) {
  Bytes bytes;
  const unsigned mask = (1U << low_bits) - 1;
  for (std::size_t i = 0; i < values.size(); i += 2) {
    const bool both = i + 1 < values.size();
    const unsigned a = values[i], b = both ? values[i + 1] : 0;
    bytes.push_back(static_cast<std::uint8_t>(a >> low_bits));
    bytes.push_back(static_cast<std::uint8_t>((a & mask) | (b & mask) << 4));
    if (both) bytes.push_back(static_cast<std::uint8_t>(b >> low_bits));
  }
  return bytes;
}
Bytes pack_mono12_packed(const Values& values) { return pack_gige(values, 4); }
Bytes pack_mono10_packed(const Values& values) { return pack_gige(values, 2); }

Bytes pack_mipi(const Values& values, unsigned group, unsigned low_bits) {
  Bytes bytes;
  for (std::size_t i = 0; i < values.size(); i += group) {
    unsigned low = 0;
    for (unsigned k = 0; k < group; ++k) {
      const unsigned value = i + k < values.size() ? values[i + k] : 0;
      bytes.push_back(static_cast<std::uint8_t>(value >> low_bits));
      low |= (value & ((1U << low_bits) - 1)) << k * low_bits;
    }
    bytes.push_back(static_cast<std::uint8_t>(low));
  }
  return bytes;
}
Bytes pack_mipi10(const Values& values) { return pack_mipi(values, 4, 2); }
Bytes pack_mipi12(const Values& values) { return pack_mipi(values, 2, 4); }

struct Packing {
  const char* name;
  unsigned bits;
  Bytes (*pack)(const Values&);
  void (*unpack)(const std::byte*, std::uint16_t*, std::size_t, InstructionSet) noexcept;
  std::size_t (*bytes)(std::size_t) noexcept;
};
const Packing kPackings[] = {
    {"mono12p", 12, pack_mono12p, unpack_mono12p, bytes_of_mono12p},
    {"mono10p", 10, pack_mono10p, unpack_mono10p, bytes_of_mono10p},
    {"mono12_packed", 12, pack_mono12_packed, unpack_mono12_packed, bytes_of_packed},
    {"mono10_packed", 10, pack_mono10_packed, unpack_mono10_packed, bytes_of_packed},
    {"mipi10", 10, pack_mipi10, unpack_mipi10, bytes_of_mipi10},
    {"mipi12", 12, pack_mipi12, unpack_mipi12, bytes_of_mipi12},
};

// Exactly as many bytes as needed, at the end of a heap block and `offset` bytes into it: a sanitizer sees any excess.
bool survives(const Packing& packing, const Values& values, std::size_t offset, InstructionSet set) {
  const Bytes packed = packing.pack(values);
  if (packed.size() != packing.bytes(values.size())) return false;
  const auto in = std::make_unique<std::byte[]>(offset + packed.size());
  std::transform(packed.begin(), packed.end(), in.get() + offset, [](std::uint8_t byte) { return std::byte{byte}; });
  constexpr std::uint16_t kUntouched = 0xBEEF;
  Values out(values.size() + 32, kUntouched);
  packing.unpack(in.get() + offset, out.data() + 1, values.size(), set);
  const auto end = out.begin() + 1 + static_cast<std::ptrdiff_t>(values.size());
  return out.front() == kUntouched && std::equal(values.begin(), values.end(), out.begin() + 1) &&
         std::all_of(end, out.end(), [](std::uint16_t value) { return value == kUntouched; });
}

RC_GTEST_PROP(Unpack, gives_back_what_was_packed_at_every_length, ()) {
  const auto seed = *rc::gen::arbitrary<std::uint32_t>();
  for (const Packing& packing : kPackings)
    for (std::size_t length = 0; length <= 200; ++length) {
      Values values(length);
      std::uint32_t state = seed + static_cast<std::uint32_t>(length);
      for (auto& value : values) {
        state = state * 1664525U + 1013904223U;
        value = static_cast<std::uint16_t>(state >> (32 - packing.bits));
      }
      for (const auto set : {InstructionSet::portable, InstructionSet::avx2, InstructionSet::avx512})
        if (set <= best_instruction_set() && !survives(packing, values, (seed + length) % 7, set))
          RC_FAIL(std::string(packing.name) + " with " + name_of(set) + ", " + std::to_string(length) + " pixels");
    }
}

TEST(Unpack, takes_every_second_byte_of_yuyv) {
  for (std::size_t pixels = 0; pixels <= 200; ++pixels) {
    const std::size_t bytes = pixels == 0 ? 0 : 2 * pixels - 1;
    const auto in = std::make_unique<std::byte[]>(bytes);
    for (std::size_t i = 0; i < bytes; ++i) in[i] = static_cast<std::byte>(i * 37);
    std::vector<std::uint8_t> out(pixels + 1, 0xEE);
    extract_yuyv_luma(in.get(), out.data(), pixels);
    for (std::size_t i = 0; i < pixels; ++i) ASSERT_EQ(out[i], static_cast<std::uint8_t>(2 * i * 37));
    EXPECT_EQ(out[pixels], 0xEE);
  }
}

}  // namespace
}  // namespace rptv
