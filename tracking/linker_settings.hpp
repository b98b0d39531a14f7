// SPDX-License-Identifier: MIT
// What the user chooses about linking particles into tracks.
#pragma once

#include <cstdint>
#include <string>

#include "core/settings.hpp"

namespace rptv {

/// Names follow trackpy where it has one. Memory taken by the linker grows with max_tracks × max_candidates.
struct LinkerSettings {
  double search_range_mm = 0.5;
  std::int64_t memory = 3;
  std::string predict = "none";
  std::int64_t max_particles = 20'000;
  std::int64_t max_tracks = 32'000;
  std::int64_t max_candidates = 32;

  void fields(FieldList& list) {
    list.number("search_range_mm", search_range_mm, 1e-9, 1e9,
                "farthest a particle may be from its (predicted) position to be the same particle, mm");
    list.integer("memory", memory, 0, 1'000'000,
                 "frames that a particle may be unseen for and still keep its identity; counts frame indices");
    list.choice("predict", predict, {"none", "velocity"},
                "where to look: 'none' at the last position, 'velocity' carried on with the last velocity");
    list.integer("max_particles", max_particles, 1, 10'000'000, "particles linked per frame; more are counted as lost");
    list.integer("max_tracks", max_tracks, 1, 10'000'000,
                 "tracks alive at once, unseen ones included (at least max_particles are kept)");
    list.integer("max_candidates", max_candidates, 1, 1024,
                 "nearest particles considered per track; linking is exact while no track has more in its range");
  }
};

}  // namespace rptv
