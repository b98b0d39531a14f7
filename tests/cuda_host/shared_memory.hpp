// SPDX-License-Identifier: MIT
// Shared memory of kernels as blocks of the heap, one per array and CUDA block, so that sanitizers see their borders.
#pragma once

#include "tests/cuda_host/collective.hpp"

namespace rptv::cuda_host {

/// The array of type T that belongs to the place in the source whose lambda has type Key.
template <class T, class Key>
T& shared(Key, const char* name, Site site) {
  static const char tag = 0;
  return *static_cast<T*>(shared_array(&tag, sizeof(T), alignof(T), name, site));
}

}  // namespace rptv::cuda_host

#define RPTV_SHARED(type, name, ...)        \
  typedef type name##_shared_t __VA_ARGS__; \
  name##_shared_t& name = ::rptv::cuda_host::shared<name##_shared_t>([] {}, #name, {__FILE__, __LINE__})

#define RPTV_DYNAMIC_SHARED(type, name) type* const name = static_cast<type*>(::rptv::cuda_host::dynamic_shared())
