// SPDX-License-Identifier: MIT
// What a user can choose about light-field reconstruction, with ranges; all of it fixed when the stage is built.
#pragma once

#include <string>
#include <vector>

#include "core/settings.hpp"

namespace rptv {

/// Lengths are in image space (origin where the axis meets the array, z towards the main lens) unless stated.
struct LightFieldSettings {
  std::string calibration;          ///< path of the calibration file
  std::string background_image;     ///< path of an image without particles; empty: the constant `background`
  double background = 0;            ///< grey level without light; 0: the calibration's, where it has one
  double threshold = 20;            ///< a pixel is lit when it is more than this above its background, grey levels;
                                    ///< times its lenslet's light where the calibration knows that
  bool running_background = false;  ///< background and noise of each pixel follow the images
  double threshold_sigmas = 6;      ///< where a pixel's own noise is known: at least this many of it
  std::int64_t background_frames = 100;  ///< how many images the running background looks back

  std::vector<double> volume_x_mm;           ///< [from, to]; empty: what the sensor covers
  std::vector<double> volume_y_mm;           ///< [from, to]; empty: what the sensor covers
  std::vector<double> volume_z_mm{-25, 25};  ///< [from, to]; positive is towards the main lens
  std::vector<double> voxel_um{125, 125, 250};

  double wavelength_nm = 0;  ///< of the light; with pitch and focal length it gives the lenslets' diffraction
  double slope_blur_um = 0;  ///< rms blur of a sub-image on the sensor, per axis, beside pixel and diffraction; what
                             ///< all shrink depths by is put back

  double particle_radius_um = 0;  ///< object space; with the magnification it gives C_min by eq. (7)
  std::int64_t min_count = 0;     ///< C_min itself; 0: by eq. (7)

  std::string counting = "coarse_to_fine";  ///< "coarse": planes an eighth of a voxel apart at the steepest ray;
                                            ///< "exhaustive": every plane of the volume
  std::string classification = "auto";      ///< "local_maxima", "dbscan", or by density; coarse to fine: local maxima
  double density_limit = 0.002;        ///< auto: fraction of voxels at or above C_min beyond which a cloud is dense
  double dbscan_radius_voxels = 1.75;  ///< eps
  std::int64_t dbscan_min_points = 1;  ///< 1: every voxel at C_min counts; more: lonely ones are noise
  std::vector<double> maximum_radius_um{190, 190, 4000};  ///< half-widths of the box that a local maximum rules

  bool explain_away = true;            ///< a pixel saw one particle: candidates claim their rays in order of support
  std::int64_t explain_rounds = 3;     ///< how often what is left is counted again
  bool refine = false;                 ///< fit the particles to the grey values themselves (shaking)
  std::string refine_search = "rays";  ///< "rays": particles are found by lit pixels, each of one particle;
                                       ///< "grey_values": by their whole images, where many overlap; seconds a frame
  std::int64_t refine_sweeps = 3;      ///< over all particles, each time
  std::int64_t refine_rounds = 2;  ///< 1: no look at what is left; more: what no particle explains is searched again
  double noise_grey = 1;           ///< rms of a dark pixel, grey levels
  double electrons_per_grey = 4;   ///< gain of the camera: the shot noise of light
  double ghost_share = 0.15;       ///< particles with less than this share of the median particle's light are ghosts

  std::int64_t max_hypotheses = 1;  ///< lenslets that one pixel may belong to where sub-images overlap
  std::int64_t max_particles = 4096;
  std::int64_t max_rays = 262144;        ///< lit pixels × hypotheses
  std::int64_t max_candidates = 262144;  ///< voxels at or above C_min
  std::int64_t threads = 1;              ///< 0: all that the machine has
  std::string space = "object";          ///< frame of reference of the particles: "object" or "image"

  void fields(FieldList& list);
};

}  // namespace rptv
