// SPDX-License-Identifier: MIT
// Chooses orders of blocks and threads, and tells ThreadSanitizer that a launch begins after its host and ends before
// it.
#include "tests/cuda_host/grid.hpp"

#include <numeric>
#include <utility>

#include "tests/cuda_host/kernel_language.hpp"
#include "tests/cuda_host/sanitizer_hooks.hpp"

namespace rptv::cuda_host {
namespace {

/// SplitMix64 (Steele, Lea, Flood: Fast splittable pseudorandom number generators, 2014).
std::uint64_t next(std::uint64_t& state) {
  std::uint64_t z = (state += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

std::vector<std::uint32_t> order(std::size_t count, std::uint64_t& state) {
  std::vector<std::uint32_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 0u);
  if (state == 0) return numbers;
  for (std::size_t i = count; i > 1; --i) std::swap(numbers[i - 1], numbers[next(state) % i]);
  return numbers;
}

}  // namespace

std::string Grid::run(dim3 blocks, const Block::Shape& shape, std::uint64_t seed, const std::function<void()>& body) {
  const std::size_t threads = std::size_t{shape.threads.x} * shape.threads.y * shape.threads.z;
  std::uint64_t state = seed;
  const std::vector<std::uint32_t> block_order = order(std::size_t{blocks.x} * blocks.y * blocks.z, state);
  gridDim = blocks;
  blockDim = shape.threads;
  running.body = &body;
  release(&launch_token);
  std::size_t turn = 0;
  for (const std::uint32_t b : block_order) {
    const uint3 index{b % blocks.x, b / blocks.x % blocks.y, b / blocks.x / blocks.y};
    const std::vector<std::uint32_t> thread_order = order(threads, state);
    Block block(index, turn++, shape, thread_order, fibers_);
    if (block.run()) continue;
    acquire(&end_token);
    return block.fault();
  }
  acquire(&end_token);
  return {};
}

}  // namespace rptv::cuda_host
