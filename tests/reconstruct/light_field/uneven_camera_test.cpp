// SPDX-License-Identifier: MIT
// A camera whose corners are dim and whose right side is noisy: thresholds by the calibration's arrays, or by one
// number.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>

#include "calibration/light_field/calibrate_lenslets.hpp"
#include "reconstruct/light_field/light_field_dark.hpp"
#include "reconstruct/lit_pixels.hpp"
#include "simulation/render_light_field.hpp"
#include "tests/bench/light_field_scene.hpp"
#include "tests/proto/place.hpp"

namespace rptv {
namespace {

constexpr double kGain = 5;  // electrons a grey value
constexpr int kDarkImages = 16, kFrames = 3;

/// Light falls to a fifth in the corners, the right third has ten times the read noise, the dark level has a pattern.
class UnevenCamera {
 public:
  explicit UnevenCamera(const ImageShape& shape) : shape_(shape) {}
  std::vector<std::uint16_t> expose(std::span<const float> electrons) {
    std::vector<std::uint16_t> grey;
    for (std::size_t i = 0; i < shape_.pixels(); ++i) {
      const double mean = electrons.empty() ? 0 : light(i) * static_cast<double>(electrons[i]);
      const double seen = mean > 0 ? std::poisson_distribution<int>(mean)(random_) : 0;
      const double level = 20 + 3 * static_cast<double>(i % 5);
      grey.push_back(
          static_cast<std::uint16_t>(std::lround(std::max(0.0, level + seen / kGain + noise(i) * normal_(random_)))));
    }
    return grey;
  }
  ImageView view(const std::vector<std::uint16_t>& grey) const {
    return {reinterpret_cast<const std::byte*>(grey.data()), shape_};
  }
  double light(std::size_t i) const {
    const double x = 2 * static_cast<double>(i % shape_.width_px) / shape_.width_px - 1;
    const double y = 2 * static_cast<double>(i / shape_.width_px) / shape_.height_px - 1;
    return 1 - 0.4 * (x * x + y * y);
  }
  double noise(std::size_t i) const { return i % shape_.width_px < 2 * shape_.width_px / 3 ? 0.4 : 4; }

 private:
  ImageShape shape_;
  std::mt19937 random_{1};
  std::normal_distribution<double> normal_;
};

ScenarioSettings scenario() {
  auto s = bench::random_scenario();
  s.seeding.particles = 45;
  s.seeding.volume_x_mm = s.seeding.volume_y_mm = 3;
  s.camera.width_px = s.camera.height_px = 960;
  s.rays_per_particle = 4096;
  return s;
}

LightFieldCalibration calibrate(UnevenCamera& camera, LightFieldRenderer& renderer, std::vector<std::uint16_t>& dark) {
  LensletImages images;
  images.origin = "white.png";
  std::vector<std::byte> unused(renderer.shape().bytes());
  renderer.render_white(0.3, unused);
  images.images.add(camera.view(camera.expose(renderer.expected())), "white.png");
  for (int k = 0; k < kDarkImages; ++k) images.dark.add(camera.view(dark = camera.expose({})), "dark.png");
  const auto level = images.dark.mean();
  for (std::size_t i = 0; i < dark.size(); ++i) dark[i] = static_cast<std::uint16_t>(std::lround(level.grey[i]));
  auto result = calibrate_lenslets(images, renderer.optics().calibration(), {true});
  const Place place;
  write_calibration_arrays(result.arrays, place.file("cal.h5"));
  result.calibration.lenslets.arrays = "cal.h5";
  write_light_field_calibration(result.calibration, place.file("cal.toml"));
  return read_light_field_calibration(place.file("cal.toml"));
}

struct Outcome {
  double in_view = 0, found = 0, ghosts = 0, false_rays = 0, lit = 0;
};

class Scene {
 public:
  Scene() : renderer_(scenario()), calibration_(calibrate(camera_, renderer_, dark_)) {
    std::vector<std::byte> unused(renderer_.shape().bytes());
    const Tracers tracers(scenario());
    for (std::uint64_t frame = 0; frame < kFrames; ++frame) {
      known_.push_back(bench::simulated_scene("", scenario(), frame));
      renderer_.render(tracers.lit(frame), frame, unused);
      electrons_.emplace_back(renderer_.expected().begin(), renderer_.expected().end());
      grey_.push_back(camera_.expose(electrons_.back()));
    }
  }
  const LightFieldCalibration& calibration() const { return calibration_; }

  /// With one number, the background is the mean of the dark images; with arrays, the calibration has it.
  Outcome outcome_of(const LightFieldCalibration& calibration, double threshold, const char* way) const {
    LightFieldSettings settings = known_.front().settings;
    settings.background = 0, settings.threshold = threshold, settings.threshold_sigmas = 3;
    const ImageView background = calibration.arrays.dark_level.empty() ? camera_.view(dark_) : ImageView{};
    const LensletLattice lattice(calibration);
    const LightFieldDark dark(settings, calibration, lattice, camera_.view(dark_).shape, background);
    LightField light_field(settings, calibration, background);
    Outcome outcome;
    for (std::size_t frame = 0; frame < kFrames; ++frame) {
      const ImageView view = camera_.view(grey_[frame]);
      std::vector<std::uint32_t> lit(grey_[frame].size());
      lit.resize(find_lit_pixels(view, dark.now().limit, lit));
      outcome.lit += static_cast<double>(lit.size());
      for (const auto pixel : lit) outcome.false_rays += is_lit(frame, pixel) ? 0 : 1;
      Particles found(4096);
      light_field.reconstruct(view, found);
      const auto matches = match(found, known_[frame]);
      outcome.ghosts += static_cast<double>(found.size() - matches.size());
      for (const char in_view : known_[frame].in_view) outcome.in_view += in_view;
      for (const auto& m : matches) outcome.found += known_[frame].in_view[m.truth];
    }
    fmt::print("threshold {:4.1f}, {}: {} of {} found, {} ghosts, {} false rays of {}\n", threshold, way, outcome.found,
               outcome.in_view, outcome.ghosts, outcome.false_rays, outcome.lit);
    return outcome;
  }

 private:
  bool is_lit(std::size_t frame, std::uint32_t pixel) const {
    return camera_.light(pixel) * static_cast<double>(electrons_[frame][pixel]) / kGain >= 1;
  }
  LightFieldRenderer renderer_;
  UnevenCamera camera_{renderer_.shape()};
  std::vector<std::uint16_t> dark_;
  LightFieldCalibration calibration_;
  std::vector<bench::KnownScene> known_;
  std::vector<std::vector<float>> electrons_;
  std::vector<std::vector<std::uint16_t>> grey_;
};

TEST(UnevenCamera, calibrated_thresholds_keep_dim_particles_and_leave_noise_out) {
  const Scene scene;
  LightFieldCalibration without = scene.calibration(), without_light = scene.calibration();
  without.arrays = {}, without_light.arrays.vignetting.clear();
  // What one number finds more, or as many, it pays for in rays that are none.
  const Outcome calibrated = scene.outcome_of(scene.calibration(), 10, "calibrated");
  EXPECT_GE(calibrated.found, 0.85 * calibrated.in_view);
  EXPECT_LE(calibrated.ghosts, 5);
  const Outcome noise_alone = scene.outcome_of(without_light, 10, "without vignetting");
  EXPECT_LE(noise_alone.found, calibrated.found - 5);
  for (const double threshold : {4.0, 6.0, 8.0, 10.0, 12.0}) {
    const Outcome one = scene.outcome_of(without, threshold, "one number");
    EXPECT_TRUE(one.found < 0.85 * calibrated.found || one.false_rays > 3 * calibrated.false_rays);
  }
}

}  // namespace
}  // namespace rptv
