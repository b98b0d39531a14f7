// SPDX-License-Identifier: MIT
// The linker's workloads and how one of them is timed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/tracking/moving_points.hpp"
#include "tracking/linker_settings.hpp"

namespace rptv {

struct LinkCase {
  std::string name;
  MovingPoints::Steps steps = MovingPoints::Steps::walk;
  std::size_t count = 1000;
  double ratio = 0.3, search_range_mm = 0.315;
  std::string predict = "none";
};

struct LinkTimes {
  std::vector<double> frame_ms, floor_ms;  ///< per frame, CPU time: linking it, and sorting its particles into cells
  double right = 0;                        ///< share of the true links that were made
  std::uint64_t largest_subnet = 0, truncated = 0, links = 0;
};

inline constexpr std::int64_t kBenchPeriodNs = 10'000'000;

double thread_ms();  ///< CPU time of this thread
double percentile(std::vector<double> values, double fraction);
LinkerSettings settings_of(const LinkCase& c);

/// Links `frames` frames after 3 that warm up. Flows with a predictor start with every fifth true first velocity.
LinkTimes measure(const LinkCase& c, std::size_t frames, std::uint64_t seed);

void print_growth();     ///< cost with N and with density, against the floor
void print_judgement();  ///< purity, coverage, fragmentation at displacement / spacing 0.1 to 0.9
void print_hostile();    ///< inputs that nobody should send
void print_hour();       ///< memory over an hour at 150 frames a second
/// frame,x,y,z,truth,vx,vy,vz: the points of a case as a table, for peers; v is the known flow of the first frame.
void write_points(const LinkCase& c, std::size_t frames, std::uint64_t seed);

}  // namespace rptv
