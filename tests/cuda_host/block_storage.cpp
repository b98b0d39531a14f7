// SPDX-License-Identifier: MIT
// Takes shared arrays from the heap one by one, and looks at what lies behind each where no sanitizer does.
#include "tests/cuda_host/block_storage.hpp"

#include <cstdlib>
#include <cstring>

#include "tests/cuda_host/sanitizer_hooks.hpp"

namespace rptv::cuda_host {
namespace {

constexpr unsigned char kUndefined = 0xA5;
constexpr unsigned char kBehind = 0x5A;
constexpr std::size_t kBehindBytes = kAddressSanitizer ? 0 : 64;

std::size_t rounded_up(std::size_t bytes, std::size_t multiple) { return (bytes + multiple - 1) / multiple * multiple; }

}  // namespace

BlockStorage::BlockStorage(std::size_t dynamic_bytes, std::size_t limit_bytes, std::size_t warps)
    : limit_bytes_(limit_bytes) {
  std::string fault;  // the launch has checked the size
  add(nullptr, dynamic_bytes, 16, "dynamic shared memory", {"", 0}, fault);
  const Unobserved unobserved;
  if (kThreadSanitizer) tokens_ = static_cast<std::uint64_t*>(std::calloc(2 + warps * 32 * 2, sizeof(std::uint64_t)));
}

BlockStorage::~BlockStorage() {
  const Unobserved unobserved;
  for (std::size_t i = 0; i < count_; ++i) std::free(arrays_[i].memory);
  std::free(tokens_);
}

void* BlockStorage::find(const void* tag) const {
  for (std::size_t i = 1; i < count_; ++i) {
    if (arrays_[i].tag == tag) return arrays_[i].memory;
  }
  return nullptr;
}

void* BlockStorage::add(const void* tag, std::size_t size_bytes, std::size_t alignment_bytes, const char* name,
                        Site site, std::string& fault) {
  const Unobserved unobserved;
  const std::string where = std::string(site.file) + ':' + std::to_string(site.line);
  const std::size_t used_bytes = rounded_up(used_bytes_, alignment_bytes) + size_bytes;
  if (used_bytes > limit_bytes_) {
    fault = where + ": with '" + name + "' the block's shared memory takes " + std::to_string(used_bytes) +
            " bytes; the launch allows " + std::to_string(limit_bytes_);
    return nullptr;
  }
  if (count_ == kArrays) {
    fault = where + ": a kernel has at most " + std::to_string(kArrays - 1) + " shared arrays here";
    return nullptr;
  }
  void* memory = nullptr;
  if (posix_memalign(&memory, rounded_up(alignment_bytes, 16), size_bytes + kBehindBytes) != 0) std::abort();
  std::memset(memory, kUndefined, size_bytes);
  std::memset(static_cast<unsigned char*>(memory) + size_bytes, kBehind, kBehindBytes);
  arrays_[count_++] = {tag, static_cast<unsigned char*>(memory), size_bytes, name};
  used_bytes_ = used_bytes;
  return memory;
}

const char* BlockStorage::overrun() const {
  const Unobserved unobserved;
  for (std::size_t i = 0; i < count_; ++i) {
    for (std::size_t k = 0; k < kBehindBytes; ++k) {
      if (arrays_[i].memory[arrays_[i].size_bytes + k] != kBehind) return arrays_[i].name;
    }
  }
  return nullptr;
}

void* BlockStorage::warp_token(std::size_t warp, unsigned first_lane) {
  if (tokens_ == nullptr) return nullptr;
  const std::size_t index = warp_index(warp, first_lane);
  return &tokens_[2 + 2 * index + (warp_meetings_[index] & 1u)];
}

void BlockStorage::warp_met(std::size_t warp, unsigned first_lane) { ++warp_meetings_[warp_index(warp, first_lane)]; }

}  // namespace rptv::cuda_host
