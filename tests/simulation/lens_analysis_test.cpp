// SPDX-License-Identifier: MIT
// First-order figures against an independent trace of the same lens, and against what the patents state.
#include "simulation/lens_analysis.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rptv {
namespace {

const std::filesystem::path kShipped = std::filesystem::path(RPTV_SOURCE_DIR) / "simulation" / "prescriptions";

TEST(LensAnalysis, double_gauss_agrees_with_an_independent_trace) {  // figures of the data set lf-macro
  const auto lens = analyse(read_prescription(kShipped / "double_gauss_f2.toml"), 1.063);
  EXPECT_NEAR(lens.efl_mm, 50.35816695831366, 1e-11);
  EXPECT_NEAR(lens.h1_z_mm, 23.23572133717501, 1e-11);
  EXPECT_NEAR(lens.h2_z_mm, 17.787738280228496, 1e-11);
  EXPECT_NEAR(lens.entrance_pupil_z_mm, 19.946482648785047, 1e-11);
  EXPECT_NEAR(lens.entrance_pupil_radius_mm, 1.5419781244609618, 1e-12);
  EXPECT_NEAR(lens.exit_pupil_z_mm, 14.268643260987762, 1e-11);
  EXPECT_NEAR(lens.exit_pupil_radius_mm, 1.6497335862922207, 1e-12);
  const auto plane = conjugates_of_magnification(lens, 1);
  EXPECT_NEAR(plane.image_mm, 100.71633391662732, 1e-11);
  const double to_array = lens.h2_z_mm + plane.image_mm - lens.exit_pupil_z_mm;
  EXPECT_NEAR(to_array, 104.23542893586806, 1e-10);
  EXPECT_NEAR(to_array / (2 * lens.exit_pupil_radius_mm), 31.591594485912534, 1e-10);
}

TEST(LensAnalysis, twelve_element_macro_is_the_patents_lens) {
  Prescription lens = read_prescription(kShipped / "macro_25mm_f28.toml").reversed().scaled(1 / 0.4971);
  const auto glasses = [&] {
    int count = 0;
    for (const auto& surface : lens.surfaces) count += surface.index_after > 1;
    return count;
  };
  EXPECT_EQ(glasses(), 12);
  const auto near = analyse(lens);
  EXPECT_NEAR(near.efl_mm, 50.30, 0.02);
  // Magnification -0.5 with the image 81.07 mm behind the last surface, as the patent states.
  const double image = 81.07 + near.length_mm - near.h2_z_mm;
  EXPECT_NEAR(image / near.efl_mm - 1, 0.5, 2e-4);
  lens.surfaces[5].thickness_mm = 1.01;  // and its state at infinity: f = 51.40, f/2.88, back focus 55.96
  lens.surfaces[9].thickness_mm = 7.61;
  const auto far = analyse(lens);
  EXPECT_NEAR(far.efl_mm, 51.40, 0.01);
  EXPECT_NEAR(far.f2_z_mm - far.length_mm, 55.96, 0.01);
  EXPECT_NEAR(far.f_number(), 2.88, 0.005);
}

TEST(LensAnalysis, shipped_macro_has_25_mm_and_works_at_2p5) {
  const auto lens = analyse(read_prescription(kShipped / "macro_25mm_f28.toml"));
  EXPECT_NEAR(lens.efl_mm, 25, 0.001);
  const auto plane = conjugates_of_magnification(lens, 2.5);
  EXPECT_GT(plane.object_mm - lens.h1_z_mm, 20);  // room for a tank before the lens
}

TEST(LensAnalysis, thin_singlet_by_the_lens_makers_equation) {
  Prescription lens;
  lens.surfaces = {{40, 0, 0, 1.5, 5}, {-40, 0, 0, 1, 5}};
  const auto figures = analyse(lens);
  EXPECT_NEAR(figures.efl_mm, 40, 1e-12);
  EXPECT_NEAR(figures.h1_z_mm, 0, 1e-12);
  EXPECT_NEAR(figures.entrance_pupil_radius_mm, 5, 1e-12);
  const auto plane = conjugates_of_object(figures, 60);
  EXPECT_NEAR(plane.image_mm, 120, 1e-10);  // eq. (8)
  EXPECT_NEAR(plane.magnification(), 2, 1e-12);
}

TEST(LensAnalysis, describes_a_lens_with_its_source) {
  const std::string text = describe_lens(read_prescription(kShipped / "double_gauss_f2.toml"), 1.063, 1);
  EXPECT_THAT(text, testing::HasSubstr("US 2,673,491"));
  EXPECT_THAT(text, testing::HasSubstr("EFL 50.3582 mm"));
  EXPECT_THAT(text, testing::HasSubstr("H1 z 23.2357, H2 z 17.7877"));
  EXPECT_THAT(text, testing::HasSubstr("cone f/31.592"));
}

}  // namespace
}  // namespace rptv
