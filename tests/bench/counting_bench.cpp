// SPDX-License-Identifier: MIT
// Ray counting: oracle loops beside ours, in one run.
#include <array>
#include <cmath>
#include <iomanip>
#include <ostream>
#include <stdexcept>

#include "reconstruct/ray_counter.hpp"
#include "tests/bench/contest.hpp"
#include "tests/bench/light_field_bench.hpp"
#include "tests/bench/timing_case.hpp"
#include "tests/reconstruct/ray_count_oracle.hpp"

namespace rptv::bench {

namespace {

constexpr std::uint16_t kLeast = 50;  // a quarter of a particle's rays

void check(const RayCounter& counter, const testing::Counts& counts) {
  for (std::int32_t z = 0; z < counter.grid().planes; ++z)
    if (!std::equal(counter.plane(z).begin(), counter.plane(z).end(),
                    counts.begin() + std::ptrdiff_t{z} * counter.grid().plane_size()))
      throw std::runtime_error("the counter differs from its oracle");
}

void bench_one(std::ostream& out, const std::array<std::int32_t, 3>& size, double slope, int rounds) {
  const TimingCase one = make_timing_case(size[0], size[1], size[2], 100'000, 500, slope);
  testing::Counts counts;
  std::vector<RayCounter> counters;
  Contest contest;
  std::size_t found = 0;
  contest.add("plain loop, ray by ray (eq. 6)", [&] {
    testing::count_ray_major(one.grid, one.rays, counts);
    found = testing::voxels_at(one.grid, counts, kLeast);
  });
  contest.add("plain loop, plane by plane", [&] {
    testing::count_plane_major(one.grid, one.rays, counts);
    found = testing::voxels_at(one.grid, counts, kLeast);
  });
  counters.reserve(3);
  for (const auto set : {InstructionSet::portable, InstructionSet::avx2, InstructionSet::avx512}) {
    if (set > best_instruction_set()) continue;
    RayCounter& counter = counters.emplace_back(one.grid, one.rays.capacity(), 1, set);
    contest.add(std::string("full volume, ") + name_of(set), [&] { counter.count(one.rays, {}, kLeast); });
  }
  contest.run(rounds);
  for (const auto& counter : counters) check(counter, counts);
  const double increments = static_cast<double>(one.rays.size) * one.grid.planes;
  out << "\n  " << size[0] << "x" << size[1] << "x" << size[2] << " voxels, 1e5 rays through 500 points, slopes up to "
      << slope << " voxels a plane; " << found << " voxels at " << kLeast << " rays\n"
      << std::setw(62) << "median ms" << std::setw(10) << "least ms" << std::setw(14) << "ns/increment" << std::setw(10)
      << "speed-up\n";
  for (std::size_t i = 0; i < contest.size(); ++i)
    out << "    " << std::left << std::setw(48) << contest.name(i) << std::right << std::fixed << std::setprecision(2)
        << std::setw(10) << contest.median_ms(i) << std::setw(10) << contest.least_ms(i) << std::setprecision(3)
        << std::setw(14) << contest.median_ms(i) * 1e6 / increments << std::setprecision(1) << std::setw(9)
        << contest.median_ms(0) / contest.median_ms(i) << std::defaultfloat << '\n';
}

}  // namespace

void bench_counting(std::ostream& out, int rounds) {
  out << "\nray counting with clear and threshold, 1 thread; results equal, checked\n";
  for (const double slope : {1.0 / 30, 0.1})  // f/30 lenslets and voxels twice as deep as wide; a steeper case
    for (const auto& size : {std::array<std::int32_t, 3>{400, 200, 150}, std::array<std::int32_t, 3>{40, 120, 401}})
      bench_one(out, size, slope, rounds);
}

}  // namespace rptv::bench
