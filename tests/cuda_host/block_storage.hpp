// SPDX-License-Identifier: MIT
// The shared memory of one CUDA block, and the tokens by which ThreadSanitizer learns what its barriers order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "tests/cuda_host/collective.hpp"

namespace rptv::cuda_host {

class BlockStorage {
 public:
  /// `limit_bytes`: of all arrays together, dynamic shared memory included.
  BlockStorage(std::size_t dynamic_bytes, std::size_t limit_bytes, std::size_t warps);
  ~BlockStorage();
  BlockStorage(const BlockStorage&) = delete;
  BlockStorage& operator=(const BlockStorage&) = delete;

  /// The array of this tag, or null when nobody asked for it yet. Safe to call on a fiber.
  void* find(const void* tag) const;
  void* dynamic() const { return arrays_[0].memory; }
  std::size_t dynamic_bytes() const { return arrays_[0].size_bytes; }

  /// Makes an array. On failure null, and `fault` says why.
  void* add(const void* tag, std::size_t size_bytes, std::size_t alignment_bytes, const char* name, Site site,
            std::string& fault);

  /// The name of an array that was written past its end, or null; under AddressSanitizer that was reported long before.
  const char* overrun() const;

  /// Tokens of the block's barrier and of a warp's meeting that begins with this lane; what meets now, and next, has
  /// its own.
  void* block_token() { return tokens_ == nullptr ? nullptr : &tokens_[block_meetings_ & 1u]; }
  void* warp_token(std::size_t warp, unsigned first_lane);
  void block_met() { ++block_meetings_; }
  void warp_met(std::size_t warp, unsigned first_lane);

 private:
  struct Array {
    const void* tag;
    unsigned char* memory;
    std::size_t size_bytes;
    const char* name;
  };
  static constexpr std::size_t kArrays = 32;

  std::size_t warp_index(std::size_t warp, unsigned first_lane) const { return warp * 32 + first_lane; }

  Array arrays_[kArrays] = {};  // the first is the dynamic one
  std::size_t count_ = 0;
  std::size_t used_bytes_ = 0;
  std::size_t limit_bytes_;
  std::uint64_t* tokens_ = nullptr;  // under ThreadSanitizer only
  std::uint32_t block_meetings_ = 0;
  std::uint32_t warp_meetings_[32 * 32] = {};
};

}  // namespace rptv::cuda_host
