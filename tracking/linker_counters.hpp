// SPDX-License-Identifier: MIT
// What the linker did and what it had to leave out, counted since construction.
#pragma once

#include <cstdint>

namespace rptv {

/// Written by the thread that calls Linker::next(). The second group stays 0 in a healthy run.
struct LinkerCounters {
  std::uint64_t frames = 0;
  std::uint64_t links = 0;           ///< particles that continued a track
  std::uint64_t births = 0;          ///< particles that began one
  std::uint64_t deaths = 0;          ///< tracks whose memory was exhausted, or that were forgotten
  std::uint64_t subnets = 0;         ///< connected subnetworks of more than one choice
  std::uint64_t largest_subnet = 0;  ///< most tracks in one of them

  std::uint64_t adapted_subnets = 0;     ///< solved at a reduced search range, after the parting of larger ones
  std::uint64_t cut_subnets = 0;         ///< assigned approximately: the deadline or adaptive_stop was reached
  std::uint64_t ignored_particles = 0;   ///< position was NaN or infinite
  std::uint64_t refused_particles = 0;   ///< beyond max_particles
  std::uint64_t truncated_searches = 0;  ///< tracks with more than max_candidates in range: only the nearest were used
  std::uint64_t forgotten_tracks = 0;    ///< unseen tracks ended early because max_tracks was reached
  std::uint64_t clock_faults = 0;        ///< frames whose exposure time went back, stood still or jumped
  std::uint64_t frame_faults = 0;        ///< frames whose index did not increase
};

}  // namespace rptv
