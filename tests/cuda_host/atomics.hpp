// SPDX-License-Identifier: MIT
// Atomic operations on integers; as on the device they order nothing else. There is none for floating point, on
// purpose: the order of additions is free, and with it the sum.
#pragma once

#include <type_traits>

namespace rptv::cuda_host {

template <class T>
inline constexpr bool kAtomic =
    std::is_same_v<T, int> || std::is_same_v<T, unsigned> || std::is_same_v<T, unsigned long long>;

/// Replaces *address by change(*address); returns what was there.
template <class T, class Change>
T replace(T* address, Change change) {
  static_assert(kAtomic<T>, "CUDA has this for int, unsigned and unsigned long long");
  T old = __atomic_load_n(address, __ATOMIC_RELAXED);
  while (!__atomic_compare_exchange_n(address, &old, change(old), false, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
  }
  return old;
}

template <class T>
struct Same {
  using Type = T;
};
template <class T>
using Operand = typename Same<T>::Type;  // not deduced: atomicAdd(&unsigned, 1) converts as in CUDA

}  // namespace rptv::cuda_host

template <class T>
T atomicAdd(T* address, rptv::cuda_host::Operand<T> value) {
  static_assert(rptv::cuda_host::kAtomic<T>, "no atomic sum of floats: its order is free; count in integers");
  return __atomic_fetch_add(address, value, __ATOMIC_RELAXED);
}
template <class T>
T atomicSub(T* address, rptv::cuda_host::Operand<T> value) {
  static_assert(rptv::cuda_host::kAtomic<T> && sizeof(T) == 4, "CUDA has this for int and unsigned");
  return __atomic_fetch_sub(address, value, __ATOMIC_RELAXED);
}
template <class T>
T atomicOr(T* address, rptv::cuda_host::Operand<T> value) {
  return rptv::cuda_host::replace(address, [=](T old) { return old | value; });
}
template <class T>
T atomicAnd(T* address, rptv::cuda_host::Operand<T> value) {
  return rptv::cuda_host::replace(address, [=](T old) { return old & value; });
}
template <class T>
T atomicXor(T* address, rptv::cuda_host::Operand<T> value) {
  return rptv::cuda_host::replace(address, [=](T old) { return old ^ value; });
}
template <class T>
T atomicMin(T* address, rptv::cuda_host::Operand<T> value) {
  return rptv::cuda_host::replace(address, [=](T old) { return value < old ? value : old; });
}
template <class T>
T atomicMax(T* address, rptv::cuda_host::Operand<T> value) {
  return rptv::cuda_host::replace(address, [=](T old) { return old < value ? value : old; });
}
template <class T>
T atomicExch(T* address, rptv::cuda_host::Operand<T> value) {
  return rptv::cuda_host::replace(address, [=](T) { return value; });
}
/// CUDA's wrapping increment: 0 after `limit`.
inline unsigned atomicInc(unsigned* address, unsigned limit) {
  return rptv::cuda_host::replace(address, [=](unsigned old) { return old >= limit ? 0u : old + 1u; });
}
template <class T>
T atomicCAS(T* address, rptv::cuda_host::Operand<T> expected, rptv::cuda_host::Operand<T> value) {
  static_assert(rptv::cuda_host::kAtomic<T>, "CUDA has this for int, unsigned and unsigned long long");
  T old = expected;
  __atomic_compare_exchange_n(address, &old, value, false, __ATOMIC_RELAXED, __ATOMIC_RELAXED);
  return old;
}
