// SPDX-License-Identifier: MIT
// Candidates from few planes: local maxima of the ray counter, smoothed over what rays drift between two planes.
#pragma once

#include <cstdint>
#include <vector>

#include "reconstruct/light_field/voxel_cloud.hpp"

namespace rptv {

/// What the smoothing of one plane writes.
struct CoarsePlane {
  std::uint16_t *smooth, *highest;  ///< like a plane of the counter
  std::uint16_t *scratch, *three;   ///< a row each
};

/// The loops over voxels, for one instruction set.
struct CoarseMaximaLoops {
  void (*smooth_plane)(const VoxelGrid& grid, const std::uint16_t* counts, const CoarsePlane& plane) noexcept;
  void (*find_peaks)(const std::uint16_t* smooth, const std::uint16_t* highest, const std::uint16_t* before,
                     const std::uint16_t* after, std::size_t size, std::uint16_t bound, std::uint8_t* peaks) noexcept;
};

/// For a counter whose planes are so far apart that rays drift up to a voxel from plane to plane (coarse to fine: the
/// N-ray fit is the fine step). The rays through any voxel at any depth between the planes are then in the 3×3 voxels
/// round it on the nearest plane: where they are fewer than C_min no voxel of a finer grid reaches C_min, and nowhere
/// else is anything looked at. All memory is taken by the constructor; one thread calls, `threads` work.
class CoarseMaxima {
 public:
  CoarseMaxima(const VoxelGrid& grid, std::size_t threads, InstructionSet set = best_instruction_set());

  /// Appends to `candidates` (up to its capacity), in raster order, the maxima among their 26 neighbours of the counts
  /// weighted 1-2-1 along x and y, where the 3×3 voxels have `least` rays or more; among equals the first in raster
  /// order wins. Their depth is the vertex of a parabola through three planes. Returns how many did not fit.
  std::size_t find(const RayCounter& counter, std::uint16_t least, std::vector<Candidate>& candidates) noexcept;

 private:
  bool is_maximum(std::size_t plane, std::size_t index) const noexcept;
  double depth_offset(std::size_t plane, std::size_t index) const noexcept;

  const VoxelGrid grid_;
  const std::size_t plane_size_, plane_blocks_;
  const CoarseMaximaLoops& loops_;
  std::vector<std::uint16_t> smooth_;             // counts weighted 1-2-1; zero on its border
  std::vector<std::uint16_t> highest_;            // of the 3×3 of smooth_ round each voxel
  std::vector<std::uint8_t> peaks_;               // of each 64 voxels: is there a maximum among them
  std::vector<std::vector<std::uint16_t>> rows_;  // two for each thread
};

}  // namespace rptv
