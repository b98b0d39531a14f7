// SPDX-License-Identifier: MIT
// The edge of the field, where rims cut the pupil to cat's eyes; calibrated from the white image at full aperture
// alone.
#include <gtest/gtest.h>

#include "tests/bench/light_field_scene.hpp"
#include "tests/calibration/light_field/traced_set.hpp"

namespace rptv {
namespace {

// Two of the 45 have most of their light beyond the sensor.
constexpr std::size_t kCanBeSeen = 43;

TEST(LfEdge, finds_all_43_that_can_be_seen_within_three_tenths_of_a_millimetre) {
  auto scene = bench::double_gauss_scene("lf-edge", "combined.png");
  if (!scene) GTEST_SKIP() << "skipped: no shared data";
  const double f_number = scene->calibration.lens.image_f_number;
  scene->calibration = testing::calibrated(testing::edge_truth(), {"white_fullaperture.png"}).result.calibration;
  scene->calibration.lens.image_f_number = f_number;
  EXPECT_EQ(scene->calibration.lens.rim_shift.size(), 2U);  // the cat's eyes are cut from both sides
  for (const std::string way : {"least squares", "fitted to the grey values", "whole images"}) {
    const bool refine = way != "least squares", whole = way == "whole images";
    scene->settings.refine = refine, scene->settings.refine_search = whole ? "grey_values" : "rays";
    LightField light_field(scene->settings, scene->calibration, {});
    Particles found(1024);
    light_field.reconstruct(scene->view(), found);
    const auto matches = match(found, *scene);
    double error = 0;
    for (const auto& m : matches) {
      const auto& at = scene->truth[m.truth].at;
      error += std::hypot(found.x_mm[m.found] - at.x, found.y_mm[m.found] - at.y, found.z_mm[m.found] - at.z);
    }
    error /= static_cast<double>(matches.size());
    fmt::print("lf-edge, {}: {} of 45 found, {} ghosts, mean {:.3f} mm\n", way, matches.size(),
               found.size() - matches.size(), error);
    EXPECT_GE(matches.size(), whole ? kCanBeSeen - 1 : kCanBeSeen);
    EXPECT_LE(found.size() - matches.size(), 1U);
    EXPECT_LE(error, refine ? 0.12 : 0.3);
  }
}

}  // namespace
}  // namespace rptv
