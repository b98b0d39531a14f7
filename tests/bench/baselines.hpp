// SPDX-License-Identifier: MIT
// How others reconstruct a light field, for comparison only: refocusing, MART and Richardson-Lucy deconvolution.
#pragma once

#include <span>

#include "reconstruct/light_field/rays.hpp"
#include "tests/bench/voxel_volume.hpp"

namespace rptv::bench {

/// Synthetic refocusing, map-shift-average (Belden et al. 2010): each lit pixel goes to each plane, bilinearly; divided
/// by the number of views. `grey[i]` is the intensity of ray i.
void refocus(const Rays& rays, std::span<const float> grey, double views, VoxelVolume& out);

/// MART, eq. (2) with relaxation 1, rays traced on the fly. Kind to it: only lit pixels are visited, and voxels that no
/// lit ray passes start at zero. Weights: 1 for the nearest voxel of each plane, or bilinear among four.
void mart(const Rays& rays, std::span<const float> grey, bool bilinear, int iterations, VoxelVolume& out);

/// Richardson-Lucy deconvolution of a focal stack in single precision with FFTW, periodic, four transforms an
/// iteration. `psf` is the stack of a point in the middle of the volume. Plans once; run() may be repeated.
class RichardsonLucy {
 public:
  explicit RichardsonLucy(const VoxelVolume& psf);
  ~RichardsonLucy();
  RichardsonLucy(const RichardsonLucy&) = delete;
  RichardsonLucy& operator=(const RichardsonLucy&) = delete;
  void run(const VoxelVolume& stack, int iterations, VoxelVolume& out);

 private:
  struct Plans;
  void blur(const float* in, bool mirrored);  // into plans_->real
  Plans* plans_;
};

/// Focal stack of a point in the middle of `grid`'s volume, of slopes within a disc, quantised by lenslets of a voxel.
VoxelVolume point_spread(const VoxelGrid& grid, double slope_radius);

}  // namespace rptv::bench
