// SPDX-License-Identifier: MIT
// Ray counting: oracle loops beside ours, in one run.
#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <ostream>
#include <stdexcept>

#include "reconstruct/light_field/coarse_maxima.hpp"
#include "tests/bench/contest.hpp"
#include "tests/bench/light_field_bench.hpp"
#include "tests/bench/timing_case.hpp"
#include "tests/reconstruct/light_field/ray_count_oracle.hpp"

namespace rptv::bench {

namespace {

constexpr std::uint16_t kLeast = 50;  // a quarter of a particle's rays

void check(const RayCounter& counter, const testing::Counts& counts) {
  for (std::int32_t z = 0; z < counter.grid().planes; ++z)
    if (!std::equal(counter.plane(z).begin(), counter.plane(z).end(),
                    counts.begin() + std::ptrdiff_t{z} * counter.grid().plane_size()))
      throw std::runtime_error("the counter differs from its oracle");
}

// The same volume in planes between which rays drift up to a voxel, as light_field.counting = "coarse_to_fine" has it.
VoxelGrid coarse_grid(const VoxelGrid& fine, double slope) {
  VoxelGrid coarse = fine;
  coarse.planes = static_cast<std::int32_t>(std::ceil(fine.planes * slope));
  coarse.step_z_mm = static_cast<float>(fine.planes) / static_cast<float>(coarse.planes);
  coarse.first_z_mm = fine.first_z_mm - 0.5F + coarse.step_z_mm / 2;
  return coarse;
}

// Points that have a candidate where the fit looks for them: within 1.5 voxels aside and a plane in depth.
std::size_t points_with_candidate(const TimingCase& one, const VoxelGrid& grid, const std::vector<Candidate>& found) {
  return static_cast<std::size_t>(std::count_if(one.points.begin(), one.points.end(), [&](const auto& point) {
    return std::any_of(found.begin(), found.end(), [&](const Candidate& c) {
      return std::abs(c.x_mm + 0.5 - point[0]) <= 1.5 && std::abs(c.y_mm + 0.5 - point[1]) <= 1.5 &&
             std::abs(static_cast<double>(c.z_mm) - point[2]) <= static_cast<double>(grid.step_z_mm);
    });
  }));
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
  const VoxelGrid coarse = coarse_grid(one.grid, slope);
  RayCounter few(coarse, one.rays.capacity(), 1);
  CoarseMaxima maxima(coarse, 1);
  std::vector<Candidate> candidates;
  candidates.reserve(100'000);
  contest.add("coarse to fine, candidates from " + std::to_string(coarse.planes) + " planes", [&] {
    candidates.clear();
    few.count(one.rays, {}, kLeast);
    maxima.find(few, kLeast, candidates);
  });
  contest.run(rounds);
  for (const auto& counter : counters) check(counter, counts);
  const double increments = static_cast<double>(one.rays.size) * one.grid.planes;
  out << "\n  " << size[0] << "x" << size[1] << "x" << size[2] << " voxels, 1e5 rays through 500 points, slopes up to "
      << slope << " voxels a plane; " << found << " voxels at " << kLeast
      << " rays;\n  coarse to fine: " << candidates.size() << " candidates, at "
      << points_with_candidate(one, coarse, candidates) << " of 500 points\n"
      << std::setw(62) << "median ms" << std::setw(10) << "least ms" << std::setw(14) << "ns/increment" << std::setw(10)
      << "speed-up\n";
  for (std::size_t i = 0; i < contest.size(); ++i)
    out << "    " << std::left << std::setw(48) << contest.name(i) << std::right << std::fixed << std::setprecision(2)
        << std::setw(10) << contest.median_ms(i) << std::setw(10) << contest.least_ms(i) << std::setprecision(3)
        << std::setw(14) << contest.median_ms(i) * 1e6 / increments << std::setprecision(1) << std::setw(9)
        << contest.median_ms(0) / contest.median_ms(i) << std::defaultfloat << '\n';
}

}  // namespace

void bench_counting(std::ostream& out, const LightFieldBenchOptions& options) {
  out << "\nray counting with clear and threshold, 1 thread; results equal, checked\n";
  for (const double slope : {1.0 / 30, 0.1})  // f/30 lenslets and voxels twice as deep as wide; a steeper case
    for (const auto& size : {std::array<std::int32_t, 3>{400, 200, 150}, std::array<std::int32_t, 3>{40, 120, 401}})
      bench_one(out, size, slope, options.rounds);
}

}  // namespace rptv::bench
