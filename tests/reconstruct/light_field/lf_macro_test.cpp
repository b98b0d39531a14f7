// SPDX-License-Identifier: MIT
// The ray-traced macro lens: 45 particles on three planes, real glass, true positions of the images.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "calibration/light_field/object_map.hpp"
#include "reconstruct/light_field/light_field.hpp"
#include "tests/reconstruct/shared_data.hpp"

namespace rptv {
namespace {

using testing::Position;

// A true positive is within a voxel-scale distance aside and half the depth resolution of the ray counter in depth.
constexpr double kLateralMm = 0.25, kDepthMm = 2;

LightFieldCalibration macro_calibration() {
  return read_light_field_calibration(RPTV_SOURCE_DIR "/tests/reconstruct/data/lf_macro_calibration.toml");
}

LightFieldSettings macro_settings() {
  LightFieldSettings settings;
  settings.threshold = 15;
  settings.particle_radius_um = 30;
  settings.volume_z_mm = {-16, 16};
  settings.space = "image";
  return settings;
}

// The numbers behind every `"key": [` in order; a line that names plane `plane` must precede them (empty: any plane).
std::vector<Position> truth_of(const std::filesystem::path& file, const std::string& plane) {
  std::vector<Position> positions;
  const std::string text = testing::text_of(file);
  const std::string key = "\"image_real_ls_mm\"";
  for (auto at = text.find(key); at != std::string::npos; at = text.find(key, at + 1)) {
    const auto begin = text.rfind("\"plane\"", at);
    const auto open = text.find('[', at);
    Position p{};
    std::string numbers = text.substr(open + 1, text.find(']', open) - open - 1);
    if (begin == std::string::npos || std::sscanf(numbers.c_str(), "%lf , %lf , %lf", &p[0], &p[1], &p[2]) != 3)
      continue;
    p[2] = -p[2];  // the truth counts z in the direction of the light
    if (plane.empty() || text.compare(text.find(':', begin) + 3, plane.size(), plane) == 0) positions.push_back(p);
  }
  return positions;
}

struct Outcome {
  std::size_t truth, found, ghosts;
  testing::ErrorFigures errors;
};

Outcome outcome_of(const LightFieldSettings& settings, const std::string& image, const std::string& plane) {
  const auto folder = *testing::shared_set("lf-macro");
  const auto truth = truth_of(folder / "truth.json", plane);
  const testing::DecodedImage pixels(folder / image);
  LightField light_field(settings, macro_calibration(), {});
  Particles particles(4096);
  light_field.reconstruct(pixels.view(), particles);
  const auto matches = testing::match(particles, truth, kLateralMm, kDepthMm);
  const Outcome outcome{truth.size(), matches.size(), particles.size() - matches.size(),
                        testing::errors_of(particles, truth, matches)};
  const auto& e = outcome.errors;
  const auto& counts = light_field.counts();
  fmt::print(
      "{} ({}, {}): {} of {} particles, {} ghosts, mean image-space error {:.3f} mm, rms x {:.4f} y {:.4f} z {:.3f} "
      "mm, "
      "bias z {:+.3f} mm; {} lit pixels, {} candidates, {} rounds\n",
      image, settings.counting, settings.classification, outcome.found, outcome.truth, outcome.ghosts, e.mean, e.rms[0],
      e.rms[1], e.rms[2], e.bias[2], counts.lit_pixels, counts.candidates, counts.rounds);
  return outcome;
}

class LfMacro : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!testing::shared_set("lf-macro")) GTEST_SKIP() << "skipped: no shared data";
  }
};

TEST_F(LfMacro, finds_at_least_44_of_45_with_at_most_1_ghost_within_a_quarter_millimetre) {
  const auto outcome = outcome_of(macro_settings(), "combined.png", "");
  ASSERT_EQ(outcome.truth, 45U);
  EXPECT_GE(outcome.found, 44U);
  EXPECT_LE(outcome.ghosts, 1U);
  EXPECT_LE(outcome.errors.mean, 0.25);
}

TEST_F(LfMacro, fitted_to_the_grey_values_places_all_45_within_a_seventh_of_a_millimetre) {
  auto settings = macro_settings();
  settings.refine = true, settings.noise_grey = 0.6;
  const auto outcome = outcome_of(settings, "combined.png", "");
  EXPECT_EQ(outcome.found, 45U);
  EXPECT_EQ(outcome.ghosts, 0U);
  EXPECT_LE(outcome.errors.mean, 0.15);
  for (const char* plane : {"d0", "d2"}) {  // off the array plane
    const auto alone = outcome_of(settings, fmt::format("plane_{}.png", plane), plane);
    EXPECT_LE(std::hypot(alone.errors.rms[0], alone.errors.rms[1]), 0.006) << plane;
  }
}

TEST_F(LfMacro, holds_the_bars_with_every_way_of_counting_and_classifying) {
  const std::pair<const char*, const char*> ways[]{{"coarse_to_fine", "auto"},
                                                   {"coarse", "local_maxima"},
                                                   {"coarse", "dbscan"},
                                                   {"exhaustive", "local_maxima"},
                                                   {"exhaustive", "dbscan"}};
  for (const auto& [counting, classification] : ways) {
    auto settings = macro_settings();
    settings.counting = counting, settings.classification = classification;
    const auto outcome = outcome_of(settings, "combined.png", "");
    EXPECT_GE(outcome.found, 44U) << counting << ' ' << classification;
    EXPECT_LE(outcome.ghosts, 1U) << counting << ' ' << classification;
    EXPECT_LE(outcome.errors.mean, 0.25) << counting << ' ' << classification;
  }
}

TEST_F(LfMacro, finds_each_plane_of_particles_alone) {
  for (const std::string plane : {"d0", "d1", "d2"}) {
    const auto outcome = outcome_of(macro_settings(), "plane_" + plane + ".png", plane);
    ASSERT_EQ(outcome.truth, 15U);
    EXPECT_EQ(outcome.found, 15U) << plane;
    EXPECT_EQ(outcome.ghosts, 0U) << plane;
    EXPECT_LE(outcome.errors.mean, 0.25) << plane;
  }
}

TEST_F(LfMacro, without_explaining_away_finds_ghosts) {
  auto settings = macro_settings();
  settings.explain_away = false, settings.counting = "coarse";
  const auto outcome = outcome_of(settings, "combined.png", "");
  EXPECT_GE(outcome.found, 40U);
  EXPECT_GT(outcome.ghosts, 1U);
}

}  // namespace
}  // namespace rptv
