// SPDX-License-Identifier: MIT
// PTX instructions on floats, comparisons and conversions, as IEEE 754 and the PTX manual have them. What a device may
// round otherwise (approximations, flushed subnormals, products that ptxas may fuse with sums) is refused.
#include <bit>
#include <cmath>
#include <functional>
#include <limits>

#include "tests/cuda_host/ptx_functions.hpp"

namespace rptv::cuda_host {
namespace {

using Bits = std::uint64_t;

template <class F>
using BitsOf = std::conditional_t<sizeof(F) == 4, std::uint32_t, std::uint64_t>;
template <class F>
F as(Bits bits) {
  return std::bit_cast<F>(static_cast<BitsOf<F>>(bits));
}
template <class F>
Bits result(F value) {
  return std::bit_cast<BitsOf<F>>(value);
}

/// a + b towards zero: the nearest sum, stepped back where it lies beyond the exact one (error by Knuth's two-sum).
template <class F>
F sum_towards_zero(F a, F b) {
  const F sum = a + b;
  if (std::isnan(sum) || std::isinf(a) || std::isinf(b)) return sum;
  if (std::isinf(sum)) return std::copysign(std::numeric_limits<F>::max(), sum);
  const F part = sum - a;
  const F error = (a - (sum - part)) + (b - part);
  const bool beyond = error != 0 && std::signbit(error) != std::signbit(sum);
  return beyond ? std::nextafter(sum, F{0}) : sum;
}

/// The lesser (or greater); a number before not-a-number, -0 before +0.
template <class F>
F lesser(F a, F b) {
  if (std::isnan(a)) return b;
  if (std::isnan(b)) return a;
  if (a == b) return std::signbit(a) ? a : b;
  return a < b ? a : b;
}

template <class F>
PtxCompute function(const std::string& op) {
  if (op == "add.rn") return [](Bits a, Bits b, Bits) { return result(as<F>(a) + as<F>(b)); };
  if (op == "add.rz") return [](Bits a, Bits b, Bits) { return result(sum_towards_zero(as<F>(a), as<F>(b))); };
  if (op == "sub.rn") return [](Bits a, Bits b, Bits) { return result(as<F>(a) - as<F>(b)); };
  if (op == "mul.rn") return [](Bits a, Bits b, Bits) { return result(as<F>(a) * as<F>(b)); };
  if (op == "div.rn") return [](Bits a, Bits b, Bits) { return result(as<F>(a) / as<F>(b)); };
  if (op == "rcp.rn") return [](Bits a, Bits, Bits) { return result(F{1} / as<F>(a)); };
  if (op == "sqrt.rn") return [](Bits a, Bits, Bits) { return result(std::sqrt(as<F>(a))); };
  if (op == "fma.rn") return [](Bits a, Bits b, Bits c) { return result(std::fma(as<F>(a), as<F>(b), as<F>(c))); };
  if (op == "min") return [](Bits a, Bits b, Bits) { return result(lesser(as<F>(a), as<F>(b))); };
  if (op == "max") return [](Bits a, Bits b, Bits) { return result(-lesser(-as<F>(a), -as<F>(b))); };
  if (op == "abs") return [](Bits a, Bits, Bits) { return result(std::fabs(as<F>(a))); };
  if (op == "neg") return [](Bits a, Bits, Bits) { return result(-as<F>(a)); };
  if (op == "copysign") return [](Bits a, Bits b, Bits) { return result(std::copysign(as<F>(b), as<F>(a))); };
  if (op == "selp") return [](Bits a, Bits b, Bits c) { return c != 0 ? a : b; };
  return nullptr;
}

/// Relations of integers; `lo`, `ls`, `hi`, `hs` are their unsigned names.
template <class T>
PtxCompute ordered(const std::string& relation) {
  const auto read = [](Bits bits) {
    if constexpr (std::is_floating_point_v<T>)
      return as<T>(bits);
    else
      return static_cast<T>(bits);
  };
  using Read = decltype(read);
  if (relation == "eq") return [](Bits a, Bits b, Bits) -> Bits { return Read{}(a) == Read{}(b); };
  if (relation == "ne")
    return [](Bits a, Bits b, Bits) -> Bits { return Read{}(a) < Read{}(b) || Read{}(a) > Read{}(b); };
  if (relation == "lt" || relation == "lo") return [](Bits a, Bits b, Bits) -> Bits { return Read{}(a) < Read{}(b); };
  if (relation == "le" || relation == "ls") return [](Bits a, Bits b, Bits) -> Bits { return Read{}(a) <= Read{}(b); };
  if (relation == "gt" || relation == "hi") return [](Bits a, Bits b, Bits) -> Bits { return Read{}(a) > Read{}(b); };
  if (relation == "ge" || relation == "hs") return [](Bits a, Bits b, Bits) -> Bits { return Read{}(a) >= Read{}(b); };
  return nullptr;
}

/// The relations that hold where either side is not a number, too, and those about that alone.
template <class F>
PtxCompute unordered(const std::string& relation) {
  if (relation == "equ")
    return [](Bits a, Bits b, Bits) -> Bits { return !(as<F>(a) < as<F>(b) || as<F>(a) > as<F>(b)); };
  if (relation == "neu") return [](Bits a, Bits b, Bits) -> Bits { return !(as<F>(a) == as<F>(b)); };
  if (relation == "ltu") return [](Bits a, Bits b, Bits) -> Bits { return !(as<F>(a) >= as<F>(b)); };
  if (relation == "leu") return [](Bits a, Bits b, Bits) -> Bits { return !(as<F>(a) > as<F>(b)); };
  if (relation == "gtu") return [](Bits a, Bits b, Bits) -> Bits { return !(as<F>(a) <= as<F>(b)); };
  if (relation == "geu") return [](Bits a, Bits b, Bits) -> Bits { return !(as<F>(a) < as<F>(b)); };
  if (relation == "num")
    return [](Bits a, Bits b, Bits) -> Bits { return !std::isnan(as<F>(a)) && !std::isnan(as<F>(b)); };
  if (relation == "nan")
    return [](Bits a, Bits b, Bits) -> Bits { return std::isnan(as<F>(a)) || std::isnan(as<F>(b)); };
  return ordered<F>(relation);
}

double whole(double value, const std::string& rounding) {
  if (rounding == "rni") return std::nearbyint(value);
  if (rounding == "rzi") return std::trunc(value);
  if (rounding == "rmi") return std::floor(value);
  if (rounding == "rpi") return std::ceil(value);
  return value;
}

/// To the nearest integer that the type has; not-a-number becomes 0, of 64 bits the highest bit alone.
Bits clamped(double value, PtxType to) {
  const bool is_signed = to.kind == 's';
  if (std::isnan(value)) return to.bits == 64 ? Bits{1} << 63 : 0;
  const double end = std::ldexp(1.0, to.bits - (is_signed ? 1 : 0));
  const Bits highest = ~Bits{0} >> (64 - to.bits + (is_signed ? 1 : 0));
  if (value >= end) return highest;
  if (!is_signed) return value <= 0 ? 0 : static_cast<Bits>(value);
  return value < -end ? highest + 1 : static_cast<Bits>(static_cast<std::int64_t>(value));
}

}  // namespace

PtxCompute ptx_float_function(const std::string& operation, PtxType type) {
  return type.bits == 32 ? function<float>(operation) : function<double>(operation);
}

PtxCompute ptx_comparison(const std::string& relation, PtxType type) {
  if (type.kind == 'f') return type.bits == 32 ? unordered<float>(relation) : unordered<double>(relation);
  const bool is_signed = type.kind == 's';
  if (type.bits == 16) return is_signed ? ordered<std::int16_t>(relation) : ordered<std::uint16_t>(relation);
  if (type.bits == 32) return is_signed ? ordered<std::int32_t>(relation) : ordered<std::uint32_t>(relation);
  return is_signed ? ordered<std::int64_t>(relation) : ordered<std::uint64_t>(relation);
}

std::uint64_t ptx_convert(std::uint64_t value, PtxType from, PtxType to, const std::string& rounding) {
  const Bits kept = to.bits == 64 ? ~Bits{0} : (Bits{1} << to.bits) - 1;
  if (from.kind == 'f') {
    const double number = whole(from.bits == 32 ? static_cast<double>(as<float>(value)) : as<double>(value), rounding);
    if (to.kind != 'f') return clamped(number, to) & kept;
    return to.bits == 64 ? result(number) : result(static_cast<float>(number));
  }
  const Bits low = from.bits == 64 ? value : value & ((Bits{1} << from.bits) - 1);
  const bool negative = from.kind == 's' && (low >> (from.bits - 1) & 1u) != 0;
  const Bits extended = negative && from.bits < 64 ? low | ~Bits{0} << from.bits : low;
  if (to.kind != 'f') return extended & kept;
  const auto number = static_cast<std::int64_t>(extended);
  if (to.bits == 64)
    return from.kind == 's' ? result(static_cast<double>(number)) : result(static_cast<double>(extended));
  return from.kind == 's' ? result(static_cast<float>(number)) : result(static_cast<float>(extended));
}

}  // namespace rptv::cuda_host
