// SPDX-License-Identifier: MIT
// The ray-traced oscillating wall at 2.5x: dense, deep, diffracting; its truth says which particles are fully in view.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/csv.hpp"
#include "reconstruct/light_field/light_field.hpp"
#include "tests/reconstruct/shared_data.hpp"

namespace rptv {
namespace {

using testing::Position;

struct Truth {
  std::vector<Position> positions;
  std::vector<bool> fully_in_view;
};

// Object positions of one frame; the set's Z counts towards the lens, like ours.
Truth truth_of(const std::filesystem::path& file, std::uint64_t frame) {
  CsvReader csv(file, {{"frame"}, {"X_mm"}, {"Y_mm"}, {"Z_mm"}, {"footprint_fully_in_fov"}});
  Truth truth;
  while (csv.next()) {
    if (csv.index(0) != frame) continue;
    truth.positions.push_back({csv.number(1), csv.number(2), csv.number(3)});
    truth.fully_in_view.push_back(csv.number(4) != 0);
  }
  return truth;
}

struct Outcome {
  std::size_t in_view = 0, hits = 0, ghosts = 0, frames = 0;
  double mean = 0;
};

// A true positive lies within 0.1 mm aside and 0.5 mm in depth of object space.
Outcome outcome_of(const std::filesystem::path& folder, bool refine) {
  const auto calibration =
      read_light_field_calibration(RPTV_SOURCE_DIR "/tests/reconstruct/data/lf_wall_calibration.toml");
  LightFieldSettings settings;
  settings.threshold = 5;
  settings.particle_radius_um = 15;
  settings.volume_z_mm = {-36, 20};
  settings.wavelength_nm = 532;
  settings.noise_grey = 0.6, settings.electrons_per_grey = 5;
  settings.refine = refine;
  LightField light_field(settings, calibration, {});
  Particles found(4096);
  Outcome outcome;
  for (const std::uint64_t frame : {0U, 30U}) {
    const Truth truth = truth_of(folder / "tracks.csv", frame);
    const testing::DecodedImage image(folder / fmt::format("frame_{:03}.png", frame));
    light_field.reconstruct(image.view(), found);
    const auto matches = testing::match(found, truth.positions, 0.1, 0.5);
    std::vector<testing::Match> full;
    for (const auto& m : matches)
      if (truth.fully_in_view[m.truth]) full.push_back(m);
    outcome.in_view +=
        static_cast<std::size_t>(std::count(truth.fully_in_view.begin(), truth.fully_in_view.end(), true));
    outcome.hits += full.size();
    outcome.ghosts += found.size() - matches.size();
    const auto errors = testing::errors_of(found, truth.positions, full);
    outcome.mean += errors.mean / 2;
    fmt::print("frame {}: object-space error mean {:.3f} mm, rms x {:.4f} y {:.4f} z {:.3f} mm, bias z {:+.3f} mm\n",
               frame, errors.mean, errors.rms[0], errors.rms[1], errors.rms[2], errors.bias[2]);
  }
  fmt::print("lf-wall, 2 frames, {}: {} of {} particles fully in view, {} ghosts, mean object-space error {:.3f} mm\n",
             refine ? "fitted to the grey values" : "least squares", outcome.hits, outcome.in_view, outcome.ghosts,
             outcome.mean);
  return outcome;
}

TEST(LfWall, finds_95_percent_of_the_particles_in_view_with_few_ghosts) {
  const auto folder = testing::shared_set("lf-wall");
  if (!folder) GTEST_SKIP() << "skipped: no shared data";
  const Outcome outcome = outcome_of(*folder, false);
  EXPECT_GE(static_cast<double>(outcome.hits), 0.95 * static_cast<double>(outcome.in_view));
  EXPECT_LE(outcome.ghosts, 10U);
  EXPECT_LE(outcome.mean, 0.125);
}

TEST(LfWall, fitted_to_the_grey_values_finds_98_percent_within_40_micrometres) {
  const auto folder = testing::shared_set("lf-wall");
  if (!folder) GTEST_SKIP() << "skipped: no shared data";
  const Outcome outcome = outcome_of(*folder, true);
  EXPECT_GE(static_cast<double>(outcome.hits), 0.98 * static_cast<double>(outcome.in_view));
  EXPECT_LE(outcome.ghosts, outcome.in_view / 100);
  EXPECT_LE(outcome.mean, 0.040);
}

}  // namespace
}  // namespace rptv
