// SPDX-License-Identifier: MIT
// PTX instructions that take words apart and put them together: bfi, prmt, lop3, shf. A fourth operand comes in the
// high half of the third.
#include <algorithm>

#include "tests/cuda_host/ptx_functions.hpp"

namespace rptv::cuda_host {
namespace {

using Bits = std::uint64_t;

/// `length` low bits of a replace those of b from `at` on.
template <unsigned width>
Bits insert(Bits a, Bits b, Bits at_and_length) {
  const unsigned at = at_and_length & 0xff, length = at_and_length >> 32 & 0xff;
  Bits word = b;
  for (unsigned i = 0; i < length && at + i < width; ++i) {
    const Bits bit = Bits{1} << (at + i);
    word = (a >> i & 1u) != 0 ? word | bit : word & ~bit;
  }
  return word;
}

/// Four bytes of the eight in b:a, chosen by the four low digits of c; the digit's bit 3 repeats the byte's sign.
Bits permute(Bits a, Bits b, Bits c) {
  const Bits all = (a & 0xffffffffu) | b << 32;
  Bits word = 0;
  for (unsigned i = 0; i < 4; ++i) {
    const Bits digit = c >> (4 * i) & 0xf;
    Bits byte = all >> (8 * (digit & 7)) & 0xff;
    if ((digit & 8) != 0) byte = (byte & 0x80) != 0 ? 0xff : 0;
    word |= byte << (8 * i);
  }
  return word;
}

/// Bit i of the result is bit (a_i b_i c_i) of the table.
Bits by_table(Bits a, Bits b, Bits c_and_table) {
  Bits word = 0;
  for (unsigned i = 0; i < 32; ++i) {
    const Bits row = (a >> i & 1u) << 2 | (b >> i & 1u) << 1 | (c_and_table >> i & 1u);
    word |= (c_and_table >> (32 + row) & 1u) << i;
  }
  return word;
}

/// The high (low) word of b:a shifted left (right).
template <bool left, bool wrap>
Bits funnel(Bits a, Bits b, Bits by) {
  const Bits all = (a & 0xffffffffu) | b << 32;
  const Bits n = wrap ? by & 31u : std::min<Bits>(by & 0xffffffffu, 32);
  return (left ? all << n >> 32 : all >> n) & 0xffffffffu;
}

}  // namespace

PtxCompute ptx_bit_field_function(const std::string& operation, PtxType type) {
  if (operation == "bfi") return type.bits == 32 ? &insert<32> : &insert<64>;
  if (type.bits != 32) return nullptr;
  if (operation == "prmt") return &permute;
  if (operation == "lop3") return &by_table;
  if (operation == "shf.l.wrap") return &funnel<true, true>;
  if (operation == "shf.l.clamp") return &funnel<true, false>;
  if (operation == "shf.r.wrap") return &funnel<false, true>;
  if (operation == "shf.r.clamp") return &funnel<false, false>;
  return nullptr;
}

}  // namespace rptv::cuda_host
