// SPDX-License-Identifier: MIT
// Blocks of device memory: closed to everybody except while work of the device runs. And ranges of page-locked host
// memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>

namespace rptv::cuda_host {

class DeviceMemory {
 public:
  ~DeviceMemory();
  void* allocate(std::size_t bytes);
  /// False where no block begins there.
  bool release(void* pointer);
  /// All blocks, for kernels and copies.
  void open();
  void close();

  /// Whether the address lies in a block, in one or at its end, and whether the whole range lies in one.
  bool holds(const void* pointer) const { return holds(pointer, 1); }
  bool holds_or_ends(const void* pointer) const { return holds(pointer, 0); }
  bool holds(const void* pointer, std::size_t bytes) const;
  std::size_t bytes_in_use() const;
  bool is_open() const { return open_; }

  /// What lies there, for messages: "offset 1024 of a block of 1000 bytes"; null where nothing is near.
  const char* describe(const void* address, char* text, std::size_t text_size) const noexcept;

 private:
  struct Block {
    std::size_t bytes;
    unsigned char* mapping;
    std::size_t mapping_bytes;
  };
  const std::pair<const std::uintptr_t, Block>* find(const void* pointer) const;
  static void set_open(std::uintptr_t begin, const Block& block, bool open);

  std::map<std::uintptr_t, Block> blocks_;
  bool open_ = false;
};

/// Page-locked ranges; those that the stand-in allocated are its own to free.
class PinnedRanges {
 public:
  bool add(void* pointer, std::size_t bytes, bool owned);
  /// The range that begins there; false if there is none of this kind.
  bool remove(void* pointer, bool owned);
  bool hold(const void* pointer, std::size_t bytes) const;
  std::size_t size_at(const void* begin) const;

 private:
  struct Range {
    std::size_t bytes;
    bool owned;
  };
  std::map<std::uintptr_t, Range> ranges_;
};

}  // namespace rptv::cuda_host
