// SPDX-License-Identifier: MIT
// Compares measured particles and tracks with the truth, in the definitions of the 1st LPT challenge.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "simulation/truth.hpp"

namespace rptv {

struct ScoreSettings {
  /// Half-axes of the box in which a measured particle is the true one: one voxel per axis (Sciacchitano et al. 2021),
  /// mm. Depth is worse resolved than x and y by a light field: the axes have their own.
  std::array<double, 3> radius_mm{0.1, 0.1, 0.5};
};

/// Errors of the true positives per axis x, y, z: measured minus truth.
struct AxisErrors {
  std::array<double, 3> mean{};  ///< bias
  std::array<double, 3> mean_absolute{};
  std::array<double, 3> rms{};  ///< about zero, bias included
};

/// Particles, summed over all frames of the truth from the first to the last measured frame. Pairs are one to one
/// within a frame: all pairs inside the radius, the nearest first (distance in units of the radius), each particle
/// taken once.
struct DetectionScore {
  std::uint64_t frames = 0;
  std::uint64_t truth = 0;     ///< true particles in view
  std::uint64_t found = 0;     ///< of those, paired: true positives
  std::uint64_t measured = 0;  ///< all measured
  std::uint64_t partly_visible =
      0;                     ///< measured and paired with a true particle not fully in view: neither gain nor ghost
  std::uint64_t ghosts = 0;  ///< measured without a partner
  double recall = 0;         ///< found / truth
  double precision = 0;      ///< (measured - ghosts) / measured
  AxisErrors position_mm;    ///< of `found`
  double rms_mm = 0;         ///< rms of the 3D distance
};

/// Tracks. A true trajectory is one unbroken run of frames in view of one particle.
struct TrackScore {
  std::uint64_t trajectories = 0;        ///< true ones
  std::uint64_t trajectories_found = 0;  ///< of those, seen by at least one track
  std::uint64_t tracks = 0;              ///< measured identities
  std::uint64_t ghost_tracks = 0;        ///< measured identities that never met a true particle
  double purity = 0;    ///< share of the paired points of tracks that are of their track's most frequent true particle
  double coverage = 0;  ///< mean over trajectories: longest share of its frames that one track has
  double fragmentation = 0;       ///< mean number of tracks per trajectory found; 1 is ideal
  std::uint64_t id_switches = 0;  ///< times that the identity changed along a trajectory
  AxisErrors velocity_mm_s;       ///< of points with age > 0
};

struct Score {
  DetectionScore detection;
  bool linked = false;  ///< `track` is filled
  TrackScore track;
};

/// Rows may come in any order. Throws Error(bad_data) when no measured frame is in the truth.
Score score(const Measurement& measured, const std::vector<TruthRow>& truth, const ScoreSettings& settings);

}  // namespace rptv
