// SPDX-License-Identifier: MIT
// Names, ranges and docs of the light-field settings.
#include "reconstruct/light_field/light_field_settings.hpp"

namespace rptv {

void LightFieldSettings::fields(FieldList& list) {
  list.text("calibration", calibration, "light-field calibration file");
  list.text("background_image", background_image, "image without particles; empty: the constant background");
  list.number("background", background, 0, 65535,
              "grey level without light; 0: each pixel's dark level, where the calibration has it");
  list.number("threshold", threshold, 0, 65535,
              "a pixel is lit when it is more than this above its background; where the calibration has vignetting, "
              "times the light of the pixel's lenslet");
  list.flag("running_background", running_background,
            "background and noise of each pixel follow the images; starts from the one given");
  list.number(
      "threshold_sigmas", threshold_sigmas, 0, 1000,
      "with a running background, or a calibration that has the noise: a lit pixel is also this many of its own "
      "noise above its background");
  list.integer("background_frames", background_frames, 2, 100000,
               "images (times 16) that the running background looks back");
  list.numbers("volume_x_mm", volume_x_mm, 0, -1e4, 1e4, "image space [from, to]; empty: what the sensor covers");
  list.numbers("volume_y_mm", volume_y_mm, 0, -1e4, 1e4, "image space [from, to]; empty: what the sensor covers");
  list.numbers("volume_z_mm", volume_z_mm, 2, -1e4, 1e4, "image space [from, to]; positive towards the main lens");
  list.numbers("voxel_um", voxel_um, 3, 1, 1e6, "voxel edges x, y, z in image space");
  list.number("wavelength_nm", wavelength_nm, 0, 1e5, "of the light: gives the diffraction of the lenslets; 0: none");
  list.number("slope_blur_um", slope_blur_um, 0, 1000, "rms blur of a sub-image beside pixel and diffraction");
  list.number("particle_radius_um", particle_radius_um, 0, 1e5, "in the object; gives C_min by eq. (7)");
  list.integer("min_count", min_count, 0, 65535, "C_min, rays through a voxel; 0: by eq. (7)");
  list.choice("counting", counting, {"coarse_to_fine", "coarse", "exhaustive"},
              "planes counted: those that show where particles are, those that depth resolution needs, or all");
  list.choice("classification", classification, {"auto", "local_maxima", "dbscan"}, "how voxels become candidates");
  list.number("density_limit", density_limit, 0, 1,
              "auto: fraction of voxels at C_min from which local maxima are used");
  list.number("dbscan_radius_voxels", dbscan_radius_voxels, 1, 16, "DBSCAN neighbourhood radius");
  list.integer("dbscan_min_points", dbscan_min_points, 1, 1000, "DBSCAN points that make a core, itself included");
  list.numbers("maximum_radius_um", maximum_radius_um, 3, 0, 1e6,
               "half-widths x, y, z of the box that a local maximum rules");
  list.flag("explain_away", explain_away, "a ray belongs to one particle only");
  list.integer("explain_rounds", explain_rounds, 1, 16, "how often the rays that are left are counted");
  list.flag(
      "refine", refine,
      "fit the particles to the grey values: far more accurate, some 0.5 ms a particle (needs lens.image_f_number)");
  list.choice("refine_search", refine_search, {"rays", "grey_values"},
              "what refine looks for: lit pixels, each of one particle, or whole particles in dense images (seconds)");
  list.integer("refine_sweeps", refine_sweeps, 1, 100, "sweeps of the fit over all particles");
  list.integer("refine_rounds", refine_rounds, 1, 16,
               "1: no search in what is left of the image; more: again and again");
  list.number("noise_grey", noise_grey, 0.01, 1e4, "rms of a dark pixel");
  list.number("electrons_per_grey", electrons_per_grey, 1e-3, 1e6, "gain of the camera: photoelectrons per grey level");
  list.number("ghost_share", ghost_share, 0, 1, "less than this share of the median particle's light is a ghost");
  list.integer("max_hypotheses", max_hypotheses, 1, 64,
               "lenslets that one pixel may belong to (overlapping sub-images)");
  list.integer("max_particles", max_particles, 1, 1000000, "particles in a frame; more are counted as overflow");
  list.integer("max_rays", max_rays, 1, 100000000, "rays in a frame; more are counted as overflow");
  list.integer("max_candidates", max_candidates, 1, 100000000, "voxels at C_min; more are counted as overflow");
  list.integer("threads", threads, 0, 1024,
               "of this stage, beside those of the other stages; 0: as many as the machine has");
  list.choice("space", space, {"object", "image"}, "frame of reference of the particles");
}

}  // namespace rptv
