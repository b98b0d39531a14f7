// SPDX-License-Identifier: MIT
// Correct kernels on the executor: reduction, histogram, ballots and shuffles, for several block sizes and schedules.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

#include "tests/cuda_host/device_values.hpp"
#include "tests/cuda_host/sample_kernels.hpp"

namespace {

using namespace rptv::cuda_host::sample;
using rptv::cuda_host::DeviceValues;

struct Schedule {
  unsigned block_size;
  std::uint64_t seed;
};

class Kernels : public testing::TestWithParam<Schedule> {
 protected:
  Kernels() { rptv::cuda_host::set_schedule_seed(GetParam().seed); }
  ~Kernels() override { rptv::cuda_host::set_schedule_seed(0); }

  cudaLaunchConfig_t config(std::size_t items, std::size_t dynamic_bytes = 0) const {
    cudaLaunchConfig_t launch{};
    launch.gridDim = static_cast<unsigned>((items + GetParam().block_size - 1) / GetParam().block_size);
    launch.blockDim = GetParam().block_size;
    launch.dynamicSmemBytes = dynamic_bytes;
    return launch;
  }
};

TEST_P(Kernels, sum_by_shuffles_and_a_barrier) {
  std::vector<int> values(1000);
  std::iota(values.begin(), values.end(), -300);
  const DeviceValues<int> device_values(values);
  const cudaLaunchConfig_t launch = config(values.size());
  const DeviceValues<long long> sums(std::vector<long long>(launch.gridDim.x, 0));
  ASSERT_EQ(cudaLaunchKernelEx(&launch, block_sums, device_values.get(), 1000, sums.get()), cudaSuccess);
  const std::vector<long long> found = sums.read();
  EXPECT_EQ(std::accumulate(found.begin(), found.end(), 0LL), 1000LL * 999 / 2 - 300 * 1000)
      << rptv::cuda_host::last_fault();
}

TEST_P(Kernels, count_into_shared_memory) {
  std::vector<unsigned> values(777);
  for (unsigned i = 0; i < values.size(); ++i) values[i] = i * i;
  std::vector<unsigned> expected(64, 0);
  for (const unsigned value : values) ++expected[value % 64];
  const DeviceValues<unsigned> device_values(values);
  const DeviceValues<unsigned> bins(std::vector<unsigned>(64, 0));
  const cudaLaunchConfig_t launch = config(values.size(), 64 * sizeof(unsigned));
  ASSERT_EQ(cudaLaunchKernelEx(&launch, histogram, device_values.get(), 777, bins.get()), cudaSuccess);
  EXPECT_EQ(bins.read(), expected) << rptv::cuda_host::last_fault();
}

TEST_P(Kernels, append_by_ballot) {
  std::vector<int> values(500);
  std::iota(values.begin(), values.end(), 0);
  const DeviceValues<int> device_values(values);
  const DeviceValues<int> kept(std::vector<int>(250, -1));
  const DeviceValues<int> count(std::vector<int>(1, 0));
  const cudaLaunchConfig_t launch = config(values.size());
  ASSERT_EQ(cudaLaunchKernelEx(&launch, keep_odd, device_values.get(), 500, kept.get(), count.get()), cudaSuccess);
  EXPECT_EQ(count.read()[0], 250) << rptv::cuda_host::last_fault();
  std::vector<int> found = kept.read();
  std::sort(found.begin(), found.end());
  for (int i = 0; i < 250; ++i) EXPECT_EQ(found[static_cast<std::size_t>(i)], 2 * i + 1);
}

TEST_P(Kernels, arithmetic_is_the_hosts_bit_for_bit) {
  std::mt19937 random(7);
  std::vector<double> a, b;
  std::vector<int> m, n;
  for (int i = 0; i < 2000; ++i) {
    a.push_back(std::ldexp(static_cast<double>(random()) - 2e9, static_cast<int>(random() % 40) - 36));
    b.push_back(std::ldexp(static_cast<double>(random()) - 2e9, static_cast<int>(random() % 40) - 36));
    m.push_back(static_cast<int>(random() % 60001) - 30000);
    n.push_back(static_cast<int>(random()));
  }
  const double edges[] = {0.0,         -0.0, 0.5, -0.5, 2.5, 1e300, -1e-310, std::numeric_limits<double>::infinity(),
                          std::nan("")};
  for (std::size_t i = 0; i < std::size(edges); ++i) b[i] = edges[i];
  const DeviceValues<double> device_a(a), device_b(b);
  const DeviceValues<int> device_m(m), device_n(n);
  const DeviceValues<Arithmetic> results(std::vector<Arithmetic>(a.size()));
  const cudaLaunchConfig_t launch = config(a.size());
  ASSERT_EQ(cudaLaunchKernelEx(&launch, arithmetic, device_a.get(), device_b.get(), device_m.get(), device_n.get(),
                               2000u, results.get()),
            cudaSuccess)
      << rptv::cuda_host::last_fault();
  const std::vector<Arithmetic> found = results.read();
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Arithmetic expected = arithmetic_of(a[i], b[i], m[i], n[i]);
    EXPECT_TRUE(found[i].real == expected.real || (std::isnan(found[i].real) && std::isnan(expected.real))) << i;
    EXPECT_TRUE(found[i].single == expected.single || (std::isnan(found[i].single) && std::isnan(expected.single)))
        << i;
    EXPECT_EQ(found[i].whole, expected.whole) << i;
    EXPECT_EQ(found[i].bits, expected.bits) << i;
  }
}

TEST_P(Kernels, bits_and_votes) {
  std::mt19937 random(3);
  std::vector<unsigned> values(700);
  for (unsigned& value : values) value = static_cast<unsigned>(random()) >> random() % 32;
  const DeviceValues<unsigned> device_values(values);
  const std::vector<int> none(values.size(), -1);
  const DeviceValues<int> set(none), zeros(none), lowest(none), votes(none);
  const cudaLaunchConfig_t launch = config(values.size());
  ASSERT_EQ(cudaLaunchKernelEx(&launch, rptv::cuda_host::sample::bits_and_votes, device_values.get(), 700u, set.get(),
                               zeros.get(), lowest.get(), votes.get()),
            cudaSuccess);
  const std::vector<int> found_set = set.read(), found_zeros = zeros.read(), found_lowest = lowest.read(),
                         found_votes = votes.read();
  const auto value_at = [&](std::size_t i) { return i < values.size() ? values[i] : 0u; };
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t block = i / GetParam().block_size * GetParam().block_size, warp = i / 32 * 32;
    int odd = 0, some = 0, every = 1;
    for (std::size_t k = block; k < block + GetParam().block_size; ++k) odd += static_cast<int>(value_at(k) & 1u);
    for (std::size_t k = warp; k < warp + 32; ++k) some |= value_at(k) > 1000000u, every &= value_at(k) > 5u;
    const unsigned next = i % 16 == 15 ? values[i] : value_at(i + 1);
    EXPECT_EQ(found_set[i], std::popcount(values[i]));
    EXPECT_EQ(found_zeros[i], std::countl_zero(values[i]));
    EXPECT_EQ(found_lowest[i], values[i] == 0 ? 0 : std::countr_zero(values[i]) + 1);
    EXPECT_EQ(found_votes[i], odd + 10000 * some + 20000 * every + 40000 * (next > values[i] ? 1 : 0));
  }
}

TEST_P(Kernels, greatest_value_by_atomics) {
  std::vector<unsigned> values(300, 7);
  values[123] = values[200] = 4000000000u;
  const DeviceValues<unsigned> device_values(values), value(std::vector<unsigned>(1, 0));
  const DeviceValues<unsigned long long> packed(std::vector<unsigned long long>(1, 0));
  const cudaLaunchConfig_t launch = config(values.size());
  ASSERT_EQ(cudaLaunchKernelEx(&launch, greatest, device_values.get(), 300u, value.get(), packed.get()), cudaSuccess);
  EXPECT_EQ(value.read()[0], 4000000000u);
  EXPECT_EQ(0xffffffffu - static_cast<unsigned>(packed.read()[0]), 123u);
}

TEST_P(Kernels, fault_ends_the_launch) {
  const DeviceValues<unsigned> seen(std::vector<unsigned>(1024, 0));
  const cudaLaunchConfig_t launch = config(1);
  ASSERT_EQ(cudaLaunchKernelEx(&launch, meet_or_not, 1, seen.get()), cudaSuccess);
  ASSERT_EQ(cudaDeviceSynchronize(), cudaSuccess) << rptv::cuda_host::last_fault();
  ASSERT_EQ(cudaLaunchKernelEx(&launch, meet_or_not, 0, seen.get()), cudaSuccess);
  EXPECT_EQ(cudaDeviceSynchronize(), cudaErrorLaunchFailure);
  EXPECT_NE(rptv::cuda_host::last_fault().find("have left the kernel"), std::string::npos);
  rptv::cuda_host::forget_faults();
}

TEST_P(Kernels, overrun_of_a_shared_array_ends_the_launch) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "AddressSanitizer ends the process instead (overruns_test.cpp)";
#endif
  const DeviceValues<unsigned> sums(std::vector<unsigned>(64, 0));
  const cudaLaunchConfig_t launch = config(1);
  ASSERT_EQ(cudaLaunchKernelEx(&launch, fill_shared, 64u, sums.get()), cudaSuccess);
  ASSERT_EQ(cudaDeviceSynchronize(), cudaSuccess) << rptv::cuda_host::last_fault();
  ASSERT_EQ(cudaLaunchKernelEx(&launch, fill_shared, 65u, sums.get()), cudaSuccess);
  EXPECT_EQ(cudaDeviceSynchronize(), cudaErrorLaunchFailure);
  EXPECT_NE(rptv::cuda_host::last_fault().find("values"), std::string::npos);
  rptv::cuda_host::forget_faults();
}

INSTANTIATE_TEST_SUITE_P(schedules, Kernels,
                         testing::Values(Schedule{32, 0}, Schedule{96, 0}, Schedule{96, 5}, Schedule{256, 7}));

}  // namespace
