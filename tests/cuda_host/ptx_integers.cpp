// SPDX-License-Identifier: MIT
// PTX instructions on integers and bits.
#include <algorithm>
#include <bit>
#include <limits>
#include <type_traits>

#include "tests/cuda_host/ptx_functions.hpp"

namespace rptv::cuda_host {
namespace {

using Bits = std::uint64_t;

template <class T>
using Unsigned = std::make_unsigned_t<T>;

template <class T>
constexpr unsigned kBits = sizeof(T) * 8;

/// Twice as wide, of the same sign.
template <class T>
struct Wide;
template <>
struct Wide<std::uint16_t> {
  using Type = std::uint32_t;
};
template <>
struct Wide<std::int16_t> {
  using Type = std::int32_t;
};
template <>
struct Wide<std::uint32_t> {
  using Type = std::uint64_t;
};
template <>
struct Wide<std::int32_t> {
  using Type = std::int64_t;
};
__extension__ typedef unsigned __int128 Unsigned128;
__extension__ typedef __int128 Signed128;
template <>
struct Wide<std::uint64_t> {
  using Type = Unsigned128;
};
template <>
struct Wide<std::int64_t> {
  using Type = Signed128;
};

template <class T>
Bits result(T value) {
  return static_cast<Unsigned<T>>(value);
}

template <class T>
typename Wide<T>::Type product(Bits a, Bits b) {
  using W = typename Wide<T>::Type;
  return static_cast<W>(static_cast<W>(static_cast<T>(a)) * static_cast<W>(static_cast<T>(b)));
}

/// A shift by more than the width leaves nothing, or the sign.
template <class T>
Bits shifted_right(Bits a, Bits by) {
  const auto n = static_cast<std::uint32_t>(by);
  if (n >= kBits<T>) return std::is_signed_v<T> && static_cast<T>(a) < 0 ? result<T>(static_cast<T>(-1)) : 0;
  return result(static_cast<T>(static_cast<T>(a) >> n));
}

template <class T>
Bits bit_field(Bits a, Bits begin, Bits length) {
  const auto at = static_cast<unsigned>(begin & 0xff), count = static_cast<unsigned>(length & 0xff);
  Bits field = 0;
  const Bits sign_at = std::min(at + count - 1, kBits<T> - 1);
  const Bits sign = std::is_signed_v<T> && count > 0 ? (static_cast<Unsigned<T>>(a) >> sign_at) & 1u : 0;
  for (unsigned i = 0; i < kBits<T>; ++i) {
    const bool inside = i < count && at + i < kBits<T>;
    const Bits bit = inside ? (static_cast<Unsigned<T>>(a) >> (at + i)) & 1u : sign;
    field |= bit << i;
  }
  return field;
}

constexpr Bits kNoBit = 0xffffffffu;

/// The place of the highest bit that differs from the sign, or kNoBit.
template <class T>
Bits highest_bit(Bits a) {
  const auto seen = static_cast<Unsigned<T>>(std::is_signed_v<T> && static_cast<T>(a) < 0 ? ~a : a);
  return seen == 0 ? kNoBit : kBits<T> - 1 - static_cast<unsigned>(std::countl_zero(seen));
}

template <class T>
PtxCompute function(const std::string& op) {
  using U = Unsigned<T>;
  if (op == "add") return [](Bits a, Bits b, Bits) -> Bits { return static_cast<U>(a + b); };
  if (op == "sub") return [](Bits a, Bits b, Bits) -> Bits { return static_cast<U>(a - b); };
  if (op == "mul.lo") return [](Bits a, Bits b, Bits) -> Bits { return static_cast<U>(a * b); };
  if (op == "mad.lo") return [](Bits a, Bits b, Bits c) -> Bits { return static_cast<U>(a * b + c); };
  if (op == "mul.hi") return [](Bits a, Bits b, Bits) -> Bits { return static_cast<U>(product<T>(a, b) >> kBits<T>); };
  if (op == "mad.hi")
    return [](Bits a, Bits b, Bits c) -> Bits { return static_cast<U>((product<T>(a, b) >> kBits<T>)+c); };
  if constexpr (sizeof(T) < 8) {
    using W = std::make_unsigned_t<typename Wide<T>::Type>;
    if (op == "mul.wide") return [](Bits a, Bits b, Bits) -> Bits { return static_cast<W>(product<T>(a, b)); };
    if (op == "mad.wide")
      return [](Bits a, Bits b, Bits c) -> Bits { return static_cast<W>(static_cast<W>(product<T>(a, b)) + c); };
  }
  // The interpreter has looked at the divisor; the least number by -1 is what it is on the device.
  if (op == "div")
    return [](Bits a, Bits b, Bits) -> Bits {
      return std::is_signed_v<T> && static_cast<T>(b) == static_cast<T>(-1)
                 ? static_cast<U>(0 - a)
                 : result(static_cast<T>(static_cast<T>(a) / static_cast<T>(b)));
    };
  if (op == "rem")
    return [](Bits a, Bits b, Bits) -> Bits {
      return std::is_signed_v<T> && static_cast<T>(b) == static_cast<T>(-1)
                 ? 0
                 : result(static_cast<T>(static_cast<T>(a) % static_cast<T>(b)));
    };
  if (op == "min")
    return [](Bits a, Bits b, Bits) -> Bits { return result(std::min(static_cast<T>(a), static_cast<T>(b))); };
  if (op == "max")
    return [](Bits a, Bits b, Bits) -> Bits { return result(std::max(static_cast<T>(a), static_cast<T>(b))); };
  if (op == "neg") return [](Bits a, Bits, Bits) -> Bits { return static_cast<U>(0 - a); };
  if (op == "abs")
    return
        [](Bits a, Bits, Bits) -> Bits { return static_cast<T>(a) < T{0} ? static_cast<U>(0 - a) : static_cast<U>(a); };
  if (op == "and") return [](Bits a, Bits b, Bits) -> Bits { return static_cast<U>(a & b); };
  if (op == "or") return [](Bits a, Bits b, Bits) -> Bits { return static_cast<U>(a | b); };
  if (op == "xor") return [](Bits a, Bits b, Bits) -> Bits { return static_cast<U>(a ^ b); };
  if (op == "not") return [](Bits a, Bits, Bits) -> Bits { return static_cast<U>(~a); };
  if (op == "shl")
    return [](Bits a, Bits b, Bits) -> Bits {
      return static_cast<std::uint32_t>(b) >= kBits<T> ? 0 : static_cast<U>(a << static_cast<std::uint32_t>(b));
    };
  if (op == "shr") return [](Bits a, Bits b, Bits) -> Bits { return shifted_right<T>(a, b); };
  if (op == "popc")
    return [](Bits a, Bits, Bits) -> Bits { return static_cast<Bits>(std::popcount(static_cast<U>(a))); };
  if (op == "clz")
    return [](Bits a, Bits, Bits) -> Bits { return static_cast<Bits>(std::countl_zero(static_cast<U>(a))); };
  if (op == "selp")
    return [](Bits a, Bits b, Bits c) -> Bits { return c != 0 ? static_cast<U>(a) : static_cast<U>(b); };
  if (op == "bfe") return [](Bits a, Bits b, Bits c) -> Bits { return bit_field<T>(a, b, c); };
  if (op == "brev")
    return [](Bits a, Bits, Bits) -> Bits {
      Bits reversed = 0;
      for (unsigned i = 0; i < kBits<T>; ++i) reversed |= ((a >> i) & 1u) << (kBits<T> - 1 - i);
      return reversed;
    };
  if (op == "bfind") return [](Bits a, Bits, Bits) -> Bits { return highest_bit<T>(a); };
  if (op == "bfind.shiftamt") {
    return [](Bits a, Bits, Bits) -> Bits {
      return highest_bit<T>(a) == kNoBit ? kNoBit : kBits<T> - 1 - highest_bit<T>(a);
    };
  }
  return nullptr;
}

PtxCompute predicate_function(const std::string& op) {
  if (op == "and") return [](Bits a, Bits b, Bits) -> Bits { return a & b; };
  if (op == "or") return [](Bits a, Bits b, Bits) -> Bits { return a | b; };
  if (op == "xor") return [](Bits a, Bits b, Bits) -> Bits { return a ^ b; };
  if (op == "not") return [](Bits a, Bits, Bits) -> Bits { return a ^ 1u; };
  return nullptr;
}

}  // namespace

PtxCompute ptx_integer_function(const std::string& operation, PtxType type) {
  if (type.kind == 'p') return predicate_function(operation);
  const bool is_signed = type.kind == 's';
  switch (type.bits) {
    case 16:
      return is_signed ? function<std::int16_t>(operation) : function<std::uint16_t>(operation);
    case 32:
      return is_signed ? function<std::int32_t>(operation) : function<std::uint32_t>(operation);
    case 64:
      return is_signed ? function<std::int64_t>(operation) : function<std::uint64_t>(operation);
    default:
      return nullptr;
  }
}

}  // namespace rptv::cuda_host
