// SPDX-License-Identifier: MIT
// Maps every block between guard pages, its end as near to the upper one as alignment lets it, and opens and closes it.
#include "tests/cuda_host/device_memory.hpp"

#include <sys/mman.h>

#include <cstdio>
#include <cstring>
#include <vector>

#include "tests/cuda_host/sanitizer_hooks.hpp"

namespace rptv::cuda_host {
namespace {

constexpr std::size_t kPage = 4096;
constexpr std::size_t kAlignment = 256;

std::size_t rounded_up(std::size_t bytes, std::size_t multiple) { return (bytes + multiple - 1) / multiple * multiple; }
std::uintptr_t number(const void* pointer) { return reinterpret_cast<std::uintptr_t>(pointer); }

}  // namespace

DeviceMemory::~DeviceMemory() {
  while (!blocks_.empty()) release(reinterpret_cast<void*>(blocks_.begin()->first));
}

void* DeviceMemory::allocate(std::size_t bytes) {
  const Unobserved unobserved;
  const std::size_t inner_bytes = rounded_up(bytes, kPage);
  Block block{bytes, nullptr, inner_bytes + 2 * kPage};
  void* mapping = mmap(nullptr, block.mapping_bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (mapping == MAP_FAILED) return nullptr;
  block.mapping = static_cast<unsigned char*>(mapping);
  unsigned char* begin = block.mapping + kPage + (inner_bytes - rounded_up(bytes, kAlignment));
  mprotect(block.mapping + kPage, inner_bytes, PROT_READ | PROT_WRITE);
  std::memset(begin, 0xA5, bytes);
  forbid(block.mapping, block.mapping_bytes);
  blocks_.emplace(number(begin), block);
  set_open(number(begin), block, open_);
  return begin;
}

bool DeviceMemory::release(void* pointer) {
  const auto found = blocks_.find(number(pointer));
  if (found == blocks_.end()) return false;
  const Unobserved unobserved;
  permit(found->second.mapping, found->second.mapping_bytes);
  munmap(found->second.mapping, found->second.mapping_bytes);
  blocks_.erase(found);
  return true;
}

void DeviceMemory::set_open(std::uintptr_t begin, const Block& block, bool open) {
  void* memory = reinterpret_cast<void*>(begin);
  if (open) permit(memory, block.bytes);
  if (!open) forbid(memory, block.bytes);
  if (!kAddressSanitizer) {
    mprotect(block.mapping + kPage, block.mapping_bytes - 2 * kPage, open ? PROT_READ | PROT_WRITE : PROT_NONE);
  }
}

void DeviceMemory::open() {
  open_ = true;
  for (const auto& [begin, block] : blocks_) set_open(begin, block, true);
}

void DeviceMemory::close() {
  open_ = false;
  for (const auto& [begin, block] : blocks_) set_open(begin, block, false);
}

const std::pair<const std::uintptr_t, DeviceMemory::Block>* DeviceMemory::find(const void* pointer) const {
  auto next = blocks_.upper_bound(number(pointer));
  return next == blocks_.begin() ? nullptr : &*--next;
}

bool DeviceMemory::holds(const void* pointer, std::size_t bytes) const {
  const auto* found = find(pointer);
  if (found == nullptr) return false;
  const std::size_t offset = number(pointer) - found->first;
  return offset <= found->second.bytes && bytes <= found->second.bytes - offset;
}

std::size_t DeviceMemory::bytes_in_use() const {
  std::size_t sum = 0;
  for (const auto& [begin, block] : blocks_) sum += block.bytes;
  return sum;
}

const char* DeviceMemory::describe(const void* address, char* text, std::size_t text_size) const noexcept {
  for (const auto& [begin, block] : blocks_) {
    if (number(address) < number(block.mapping) || number(address) >= number(block.mapping) + block.mapping_bytes)
      continue;
    const auto offset = static_cast<long long>(number(address) - begin);
    std::snprintf(text, text_size, "offset %lld of a block of %zu bytes", offset, block.bytes);
    return text;
  }
  return nullptr;
}

bool PinnedRanges::add(void* pointer, std::size_t bytes, bool owned) {
  if (hold(pointer, 1)) return false;
  return ranges_.emplace(number(pointer), Range{bytes, owned}).second;
}

bool PinnedRanges::remove(void* pointer, bool owned) {
  const auto found = ranges_.find(number(pointer));
  if (found == ranges_.end() || found->second.owned != owned) return false;
  ranges_.erase(found);
  return true;
}

bool PinnedRanges::hold(const void* pointer, std::size_t bytes) const {
  auto next = ranges_.upper_bound(number(pointer));
  if (next == ranges_.begin()) return false;
  --next;
  const std::size_t offset = number(pointer) - next->first;
  return offset <= next->second.bytes && bytes <= next->second.bytes - offset;
}

std::size_t PinnedRanges::size_at(const void* begin) const {
  const auto found = ranges_.find(number(begin));
  return found == ranges_.end() ? 0 : found->second.bytes;
}

}  // namespace rptv::cuda_host
