// SPDX-License-Identifier: MIT
// The count that leaves most of the volume out finds the particles that the count of all of it finds.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "reconstruct/light_field/light_field.hpp"
#include "tests/reconstruct/light_field/small_scene.hpp"
#include "tests/reconstruct/shared_data.hpp"

namespace rptv {
namespace {

// Two fits of one particle may differ by what a few rays at the edge of its gate do: a fraction of its uncertainty.
constexpr double kSameSigma = 1.0;

struct Comparison {
  std::size_t both = 0, only_full = 0, only_coarse = 0;
  void operator+=(const Comparison& other) {
    both += other.both, only_full += other.only_full, only_coarse += other.only_coarse;
  }
};

double sigmas_between(const Particles& a, std::size_t i, const Particles& b, std::size_t j) {
  const auto& c = a.covariance_mm2[i];
  return std::max({std::abs(a.x_mm[i] - b.x_mm[j]) / std::sqrt(c[0]), std::abs(a.y_mm[i] - b.y_mm[j]) / std::sqrt(c[3]),
                   std::abs(a.z_mm[i] - b.z_mm[j]) / std::sqrt(c[5])});
}

Comparison compare(LightFieldSettings settings, const LightFieldCalibration& camera, const ImageView& image) {
  Particles full(4096), coarse(4096);
  settings.counting = "coarse_to_fine";
  LightField(settings, camera, {}).reconstruct(image, coarse);
  settings.counting = "exhaustive", settings.classification = "local_maxima";
  LightField(settings, camera, {}).reconstruct(image, full);
  Comparison result{0, full.size(), coarse.size()};
  for (std::size_t i = 0; i < full.size(); ++i)
    for (std::size_t j = 0; j < coarse.size(); ++j)
      if (sigmas_between(full, i, coarse, j) < kSameSigma) {
        ++result.both, --result.only_full, --result.only_coarse;
        break;
      }
  return result;
}

void print(const char* scene, const Comparison& c) {
  fmt::print("{}: {} particles by both counts, {} by the full one only, {} by the coarse one only\n", scene, c.both,
             c.only_full, c.only_coarse);
}

TEST(CoarseToFine, finds_the_particles_of_the_full_count_in_painted_images) {
  Comparison all;
  for (unsigned seed = 1; seed <= 6; ++seed)
    all += compare(testing::small_settings(), testing::small_camera(), testing::paint(testing::scene(seed)).view());
  print("six painted images", all);
  EXPECT_GE(all.both, 147U);
  EXPECT_LE(all.only_full + all.only_coarse, 3U);
}

TEST(CoarseToFine, finds_the_particles_of_the_full_count_through_the_macro_lens) {
  const auto folder = testing::shared_set("lf-macro");
  if (!folder) GTEST_SKIP() << "skipped: no shared data";
  LightFieldSettings settings;
  settings.threshold = 15, settings.particle_radius_um = 30, settings.volume_z_mm = {-16, 16};
  const testing::DecodedImage image(*folder / "combined.png");
  const auto camera = read_light_field_calibration(RPTV_SOURCE_DIR "/tests/reconstruct/data/lf_macro_calibration.toml");
  const Comparison result = compare(settings, camera, image.view());
  print("lf-macro", result);
  EXPECT_EQ(result.both, 45U);
  EXPECT_EQ(result.only_full + result.only_coarse, 0U);
}

TEST(CoarseToFine, finds_the_particles_of_the_full_count_above_the_wall) {
  const auto folder = testing::shared_set("lf-wall");
  if (!folder) GTEST_SKIP() << "skipped: no shared data";
  LightFieldSettings settings;
  settings.threshold = 5, settings.particle_radius_um = 15, settings.volume_z_mm = {-36, 20};
  settings.slope_blur_um = 0.33 * 0.532 * 3750 / 125;
  const auto camera = read_light_field_calibration(RPTV_SOURCE_DIR "/tests/reconstruct/data/lf_wall_calibration.toml");
  Comparison all;
  for (const int frame : {0, 15, 30, 45}) {
    const testing::DecodedImage image(*folder / fmt::format("frame_{:03}.png", frame));
    all += compare(settings, camera, image.view());
  }
  print("lf-wall, 4 frames", all);
  EXPECT_GE(all.both, 880U);
  EXPECT_LE(all.only_full + all.only_coarse, all.both / 50);
}

}  // namespace
}  // namespace rptv
