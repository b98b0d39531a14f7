// SPDX-License-Identifier: MIT
// Calibrations of the ray-traced sets from their images alone, against their truth, and reconstructions with them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "calibration/light_field/calibrate_lenslets.hpp"
#include "calibration/light_field/fit_volume.hpp"
#include "calibration/light_field/lenslet_report.hpp"
#include "core/error.hpp"
#include "reconstruct/light_field/light_field.hpp"
#include "tests/calibration/light_field/traced_set.hpp"

namespace rptv {
namespace {

using namespace testing;

class LfCalibration : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* set : {"lf-macro", "lf-edge", "lf-microchannel", "lf-wall"})
      if (!shared_set(set)) GTEST_SKIP() << "skipped: no shared data";
  }
};

TEST_F(LfCalibration, macro_lens_from_a_stopped_down_white_image) {
  const auto truth = macro_truth();
  const auto figures = calibrated(truth, {"white_stopped.png"}).figures;
  EXPECT_LT(figures.raw_median_px, 0.05);
  EXPECT_LT(figures.worst_px, 0.05);
  EXPECT_NEAR(figures.exit_pupil_mm, truth.lens.exit_pupil_mm, 0.01 * truth.lens.exit_pupil_mm);
}

TEST_F(LfCalibration, macro_lens_at_its_working_aperture) {
  const auto truth = macro_truth();
  const auto figures = calibrated(truth, {"white_fullaperture.png"}).figures;
  EXPECT_LT(figures.raw_median_px, 0.05);
  EXPECT_LT(figures.worst_px, 0.05);
  EXPECT_NEAR(figures.exit_pupil_mm, truth.lens.exit_pupil_mm, 0.01 * truth.lens.exit_pupil_mm);
}

TEST_F(LfCalibration, cats_eyes_are_left_out_and_the_lattice_holds_beyond_them) {
  const auto truth = edge_truth();
  const auto [result, figures] = calibrated(truth, {"white_fullaperture.png"});
  EXPECT_LT(figures.worst_px, 0.1);
  EXPECT_NEAR(figures.exit_pupil_mm, truth.lens.exit_pupil_mm, 0.01 * truth.lens.exit_pupil_mm);
  std::size_t eyes = 0, fitted = 0;
  for (const auto& s : result.found.spots)
    if (std::hypot(s.x_px - 1023.5, s.y_px - 767.5) > 800) ++eyes, fitted += s.reason == 0 ? 1 : 0;
  fmt::print("  beyond 800 px of the axis: {} cat's eyes, {} of them fitted\n", eyes, fitted);
  EXPECT_GT(eyes, 4000U);
  EXPECT_EQ(fitted, 0U);
}

TEST_F(LfCalibration, edge_field_from_a_stopped_down_white_image) {
  EXPECT_LT(calibrated(edge_truth(), {"white_stopped.png"}).figures.worst_px, 0.1);
}

TEST_F(LfCalibration, wall_lens_from_either_white_image) {
  for (const char* image : {"white_stopped.png", "white_fullaperture.png"}) {
    const auto figures = calibrated(wall_truth(), {image}).figures;
    EXPECT_LT(figures.worst_px, 0.05) << image;
    EXPECT_NEAR(figures.exit_pupil_mm, wall_truth().lens.exit_pupil_mm, 0.01 * wall_truth().lens.exit_pupil_mm);
  }
}

TEST_F(LfCalibration, wall_lens_from_particle_images_alone) {
  std::vector<std::string> frames;
  for (int k = 0; k < 60; ++k) frames.push_back(fmt::format("frame_{:03}.png", k));
  const auto figures = calibrated(wall_truth(), frames).figures;
  EXPECT_LT(figures.worst_px, 0.2);
  EXPECT_NEAR(figures.exit_pupil_mm, wall_truth().lens.exit_pupil_mm, 0.01 * wall_truth().lens.exit_pupil_mm);
}

TEST_F(LfCalibration, microscope_stopped_down_and_with_overlapping_sub_images) {
  for (const char* image : {"white_stopped.png", "white_fullaperture.png"}) {
    const auto [result, figures] = calibrated(microscope_truth(), {image});
    EXPECT_LT(figures.worst_px, 0.05) << image;
    EXPECT_NEAR(result.calibration.lenslets.pitch_um, 125, 0.005);
    EXPECT_EQ(result.calibration.lens.exit_pupil_mm, 0);
  }
}

TEST_F(LfCalibration, a_few_particles_do_not_make_a_calibration) {
  EXPECT_THROW(calibrated(macro_truth(), {"plane_d0.png", "plane_d1.png", "plane_d2.png"}), Error);
}

struct Score {
  std::size_t truth, found, ghosts;
  double mean_mm;
};

/// Particles of combined.png in image space with a calibration from `white`, against where the traced rays converge.
Score score_of(const LightFieldCalibration& truth, const std::string& white) {
  const auto result = calibrated(truth, {white}).result;
  const auto folder = *shared_set(set_of(truth));
  LightFieldSettings settings;
  settings.threshold = 15, settings.particle_radius_um = 30, settings.volume_z_mm = {-16, 16}, settings.space = "image";
  LightField light_field(settings, result.calibration, {});
  Particles found(4096);
  light_field.reconstruct(DecodedImage(folder / "combined.png").view(), found);
  std::vector<Position> positions;
  for (const auto& pair : traced_pairs(set_of(truth))) positions.push_back(pair.image);
  const auto matches = match(found, positions, 0.25, 2);
  const Score score{positions.size(), matches.size(), found.size() - matches.size(),
                    errors_of(found, positions, matches).mean};
  fmt::print("{} calibrated from {}: {} of {} particles, {} ghosts, mean image-space error {:.3f} mm\n", set_of(truth),
             white, score.found, score.truth, score.ghosts, score.mean_mm);
  return score;
}

TEST_F(LfCalibration, macro_particles_are_found_with_a_calibration_from_images_alone) {
  for (const char* white : {"white_stopped.png", "white_fullaperture.png"}) {
    const auto score = score_of(macro_truth(), white);
    EXPECT_GE(score.found, 44U);
    EXPECT_LE(score.ghosts, 1U);
    EXPECT_LE(score.mean_mm, 0.25);
  }
}

TEST_F(LfCalibration, edge_particles_are_found_behind_cats_eyes) {
  const auto score = score_of(edge_truth(), "white_fullaperture.png");
  EXPECT_GE(score.found, 43U);
  EXPECT_LE(score.ghosts, 1U);
  EXPECT_LE(score.mean_mm, 0.3);
}

TEST_F(LfCalibration, a_polynomial_maps_the_real_lens_better_than_its_cardinal_planes) {
  for (const auto& truth : {macro_truth(), edge_truth()}) {
    const auto pairs = traced_pairs(set_of(truth));
    const auto before = residuals_of(ObjectMap(truth), pairs);
    const auto fit = fit_volume(pairs, truth, "truth.json");
    fmt::print(
        "{}: object space, {} traced points: thick lens rms x {:.4f} y {:.4f} z {:.4f} mm; polynomial {:.4f} {:.4f} "
        "{:.4f}; points left out {:.4f} {:.4f} {:.4f}\n",
        set_of(truth), pairs.size(), before.rms[0], before.rms[1], before.rms[2], fit.residuals.rms[0],
        fit.residuals.rms[1], fit.residuals.rms[2], fit.left_out_rms[0], fit.left_out_rms[1], fit.left_out_rms[2]);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_LT(fit.left_out_rms[k], before.rms[k]);
  }
}

}  // namespace
}  // namespace rptv
