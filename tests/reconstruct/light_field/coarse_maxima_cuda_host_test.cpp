// SPDX-License-Identifier: MIT
// The device's search for coarse maxima, run on the CPU, against the CPU's own, bit for bit.
#include "reconstruct/light_field/coarse_maxima_cuda.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cstring>

#include "reconstruct/cuda_scan.hpp"
#include "reconstruct/light_field/coarse_maxima.hpp"
#include "tests/reconstruct/light_field/any_rays.hpp"
#include "tests/reconstruct/light_field/device_copies.hpp"

namespace rptv {
namespace {

using testing::from_device;
using testing::on_device;

/// What a search gives: the candidates that have room, and how many have none.
struct Found {
  std::vector<Candidate> candidates;
  std::size_t refused = 0;
  bool operator==(const Found& other) const {
    return refused == other.refused && candidates.size() == other.candidates.size() &&
           (candidates.empty() ||
            std::memcmp(candidates.data(), other.candidates.data(), candidates.size() * sizeof(Candidate)) == 0);
  }
};

Found find_on_device(const RayCounter& counter, std::uint16_t least, std::size_t room, unsigned threads) {
  const VoxelGrid& grid = counter.grid();
  std::vector<std::uint16_t> counts;
  for (std::int32_t z = 0; z < grid.planes; ++z) {
    const auto plane = counter.plane(z);
    counts.insert(counts.end(), plane.begin(), plane.end());
  }
  CudaStream stream;
  const auto device_counts = on_device(stream, counts);
  const DeviceArray<Candidate> candidate(room);
  const DeviceArray<std::uint32_t> size(1), runs(compact_runs(counts.size()));
  const DeviceArray<std::uint16_t> smooth(counts.size()), highest(counts.size());
  EXPECT_TRUE(find_coarse_maxima_cuda(
      grid, device_counts.data(), least,
      {candidate.data(), size.data(), static_cast<std::uint32_t>(room), smooth.data(), highest.data(), runs.data()},
      stream.handle(), threads));
  const std::size_t all = from_device(stream, size)[0], kept = std::min(all, room);
  return {from_device(stream, candidate, kept), all - kept};
}

RC_GTEST_PROP(CudaCoarseMaxima, are_those_of_the_cpu_in_their_order, ()) {
  const auto any = testing::any_rays();
  const auto least = *rc::gen::inRange<std::uint16_t>(1, 40);
  const auto room = *rc::gen::element<std::size_t>(1, 20, 100000);
  RayCounter counter(any.grid, any.rays.capacity(), 1);
  counter.count(any.rays, {}, least);
  Found expected;
  expected.candidates.reserve(room);
  expected.refused = CoarseMaxima(any.grid, 1).find(counter, least, expected.candidates);
  cuda_host::set_schedule_seed(*rc::gen::element<std::uint64_t>(0, 1, 5));
  const auto threads = *rc::gen::elementOf(std::vector<unsigned>{32, 96, 256});
  RC_ASSERT(find_on_device(counter, least, room, threads) == expected);
}

TEST(CudaCoarseMaxima, are_none_where_nothing_is_counted) {
  VoxelGrid grid;
  grid.size_x = 20, grid.size_y = 11, grid.planes = 3;
  EXPECT_EQ(find_on_device(RayCounter(grid, 1, 1), 1, 10, 96), Found());
}

}  // namespace
}  // namespace rptv
