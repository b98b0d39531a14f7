// SPDX-License-Identifier: MIT
// The whole camera against images that an independent Monte-Carlo ray tracer made of the same scenes.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "simulation/quadrature.hpp"
#include "simulation/render_light_field.hpp"
#include "tests/simulation/shared_light_field.hpp"

namespace rptv {
namespace {

constexpr double kGain = 4;  // photoelectrons per grey value of the data sets

/// Light and its centroid.
struct Spot {
  double light = 0, column = 0, row = 0;
  void add(double value, double i, double j) { light += value, column += value * i, row += value * j; }
  double at_column() const { return column / light; }
  double at_row() const { return row / light; }
};

class TracedCamera : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    set_ = SharedLightField::open(GetParam());
    if (!set_) GTEST_SKIP() << "RPTV_SHARED_DATA does not name the research data";
    dark_ = set_->image("dark.png").mean();
  }
  std::optional<SharedLightField> set_;
  double dark_ = 0;
};

TEST_P(TracedCamera, converges_where_the_independent_trace_converges) {
  const LightFieldOptics optics(set_->scenario());
  double mean_z = 0;
  for (const auto& particle : set_->particles()) {
    const auto real = optics.convergence(particle.object);
    ASSERT_TRUE(real);
    EXPECT_NEAR(real->x, particle.image_real.x, 5e-4);
    EXPECT_NEAR(real->y, particle.image_real.y, 5e-4);
    EXPECT_NEAR(real->z, particle.image_real.z, 0.01);
    EXPECT_NEAR(optics.image_of(particle.object).z, particle.image_paraxial.z, 1e-9);
    EXPECT_NEAR(optics.image_of(particle.object).x, particle.image_paraxial.x, 1e-9);
    mean_z += std::abs(real->z - particle.image_real.z) / static_cast<double>(set_->particles().size());
  }
  EXPECT_LT(mean_z, 0.002);
}

TEST_P(TracedCamera, lets_as_much_light_through) {
  LightFieldRenderer renderer(set_->scenario());
  std::vector<std::byte> pixels(renderer.shape().bytes());
  for (int layer = 0; layer < 3; ++layer) {
    renderer.render(set_->tracers(layer), 0, pixels);
    double all = 0, all_theirs = 0;
    auto light = renderer.lights().begin();
    for (const auto& particle : set_->particles()) {
      if (particle.layer != layer) continue;
      EXPECT_NEAR(light->photoelectrons / particle.photoelectrons, 1, 0.008);  // 5 sigma of their photons
      all += light->photoelectrons, all_theirs += particle.photoelectrons;
      ++light;
    }
    EXPECT_NEAR(all / all_theirs, 1, 0.002);
    const SharedImage theirs = set_->image(fmt::format("plane_d{}.png", layer));
    double sum = 0, sum_theirs = 0;
    for (const float value : renderer.expected()) sum += static_cast<double>(value);
    for (const double value : theirs.grey) sum_theirs += kGain * (value - dark_);
    fmt::print("{} layer {}: light on the sensor, ours over theirs {:.4f}\n", GetParam(), layer, sum / sum_theirs);
    EXPECT_NEAR(sum / sum_theirs, 1, 0.01);
  }
}

TEST_P(TracedCamera, puts_sub_images_on_the_same_pixels) {
  LightFieldRenderer renderer(set_->scenario());
  const LensletArray& array = renderer.optics().lenslets();
  const double scale = 1 + array.focal_length_mm() / renderer.optics().exit_pupil_mm();
  const double pixel = renderer.optics().calibration().pixel_mm();
  std::vector<std::byte> pixels(renderer.shape().bytes());
  for (int layer = 0; layer < 3; ++layer) {
    renderer.render(set_->tracers(layer), 0, pixels);
    const SharedImage theirs = set_->image(fmt::format("plane_d{}.png", layer));
    std::map<Lenslet, std::pair<Spot, Spot>> spots;  // ours, theirs
    for (std::size_t k = 0; k < theirs.grey.size(); ++k) {
      const auto ours = static_cast<double>(renderer.expected()[k]);
      if (ours < kGain) continue;
      const auto i = static_cast<double>(k % theirs.width), j = static_cast<double>(k / theirs.width);
      const double x = (i - 0.5 * static_cast<double>(theirs.width - 1)) * pixel / scale;
      const double y = (j - 0.5 * static_cast<double>(theirs.height - 1)) * pixel / scale;
      auto& [first, second] = spots[array.at(x, y)];
      first.add(ours, i, j);
      second.add(kGain * (theirs.grey[k] - dark_), i, j);
    }
    double mean_column = 0, mean_row = 0, square = 0, worst = 0;
    int bright = 0;
    for (const auto& [lenslet, pair] : spots) {
      const auto& [ours, other] = pair;
      if (ours.light < 15000) continue;
      const double dc = other.at_column() - ours.at_column(), dr = other.at_row() - ours.at_row();
      mean_column += dc, mean_row += dr, square += dc * dc + dr * dr;
      worst = std::max({worst, std::abs(dc), std::abs(dr)});
      ++bright;
    }
    ASSERT_GT(bright, 5);
    const double rms = std::sqrt(square / (2 * bright));
    fmt::print(
        "{} layer {}: {} sub-images, centroids apart {:+.4f}, {:+.4f} px on average, rms {:.4f}, at most {:.3f}\n",
        GetParam(), layer, bright, mean_column / bright, mean_row / bright, rms, worst);
    EXPECT_NEAR(mean_column / bright, 0, 0.03);
    EXPECT_NEAR(mean_row / bright, 0, 0.03);
    EXPECT_LT(rms, 0.05);
  }
}

/// Where the light of an even object lands that comes through one lenslet.
Spot traced_spot(const LightFieldOptics& optics, Lenslet lenslet) {
  static const auto samples = lenslet_samples(1500);
  std::vector<ArrayRay> rays(samples.size());
  const auto centre = optics.lenslet_centre(lenslet);
  optics.lens().white(centre[0], centre[1], 0.5 * optics.lenslets().pitch_mm(), samples, rays);
  std::vector<SensorMm> landings(samples.size());
  optics.lenslets().land(rays, lenslet, landings);
  Spot spot;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto point = optics.sensor_point(landings[i]);
    if (rays[i].weight > 0) spot.add(rays[i].weight, point.column, point.row);
  }
  return spot;
}

/// The light within `half` px of a point of an image.
Spot seen_spot(const SharedImage& image, double dark, const SensorPoint& at, double half) {
  Spot spot;
  for (long j = std::lround(at.row - half); j < std::lround(at.row + half); ++j)
    for (long i = std::lround(at.column - half); i < std::lround(at.column + half); ++i)
      spot.add(image.grey[static_cast<std::size_t>(j) * image.width + static_cast<std::size_t>(i)] - dark,
               static_cast<double>(i), static_cast<double>(j));
  return spot;
}

TEST_P(TracedCamera, puts_white_spots_on_the_same_pixels) {
  for (const std::string name : {"white_stopped.png", "white_fullaperture.png"}) {
    ScenarioSettings scenario = set_->scenario();
    if (name == "white_stopped.png") scenario.main_lens.stop_radius_mm = set_->number("white_stop_radius_mm");
    const LightFieldOptics optics(scenario);
    const SharedImage image = set_->image(name);
    const auto width = static_cast<double>(image.width), height = static_cast<double>(image.height);
    const double pitch_px = scenario.lenslets.pitch_mm / (1e-3 * scenario.camera.pixel_um);
    const double half = 0.5 * pitch_px * (1 + scenario.lenslets.focal_length_mm / optics.exit_pupil_mm());
    double sum_column = 0, sum_row = 0, square = 0;
    std::vector<double> shares, ratios;
    for (long v = -60; v <= 60; v += 3)
      for (long u = -80; u <= 80; u += 3) {
        const auto chief = optics.white_spot({u, v});
        if (std::min(chief.column, chief.row) < half + 1 || chief.column > width - 2 - half ||
            chief.row > height - 2 - half)
          continue;
        const Spot ours = traced_spot(optics, {u, v}), theirs = seen_spot(image, dark_, chief, half);
        const double dc = theirs.at_column() - ours.at_column(), dr = theirs.at_row() - ours.at_row();
        sum_column += dc, sum_row += dr, square += dc * dc + dr * dr;
        shares.push_back(ours.light / 1500);
        ratios.push_back(theirs.light / ours.light);
      }
    const auto spots = static_cast<double>(shares.size());
    std::nth_element(ratios.begin(), ratios.begin() + ratios.size() / 2, ratios.end());
    double light = 0;
    for (const double ratio : ratios) light += std::pow(ratio / ratios[ratios.size() / 2] - 1, 2) / spots;
    fmt::print(
        "{} {}: {} spots, apart {:+.4f}, {:+.4f} px on average, rms {:.4f}; light {:.2f} to {:.2f} of the middle's, "
        "off by {:.1f} % rms\n",
        GetParam(), name, shares.size(), sum_column / spots, sum_row / spots, std::sqrt(square / (2 * spots)),
        *std::min_element(shares.begin(), shares.end()), *std::max_element(shares.begin(), shares.end()),
        100 * std::sqrt(light));
    ASSERT_GT(spots, 300);
    EXPECT_NEAR(sum_column / spots, 0, 0.03);
    EXPECT_NEAR(sum_row / spots, 0, 0.03);
    EXPECT_LT(std::sqrt(square / (2 * spots)), 0.12);
    EXPECT_LT(std::sqrt(light), 0.05);
  }
}

INSTANTIATE_TEST_SUITE_P(DoubleGauss, TracedCamera, testing::Values("lf-macro", "lf-edge"), [](const auto& parameter) {
  return parameter.param == "lf-macro" ? "macro" : "edge_with_cats_eyes";
});

}  // namespace
}  // namespace rptv
