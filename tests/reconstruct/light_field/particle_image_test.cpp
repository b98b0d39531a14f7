// SPDX-License-Identifier: MIT
// The forward model against photons traced one by one, against itself by finite differences, and at its limits.
#include "reconstruct/light_field/particle_image.hpp"

#include <gtest/gtest.h>

#include <map>
#include <numeric>

#include "reconstruct/light_field/blur_kernel.hpp"
#include "tests/reconstruct/light_field/small_scene.hpp"
#include "tests/reconstruct/light_field/traced_image.hpp"

namespace rptv {
namespace {

using testing::kRadiusMm;
using testing::small_camera;
using testing::TracedImage;

ImageModelOptions options_of(const LightFieldCalibration& camera, double first_zero_um) {
  ImageModelOptions options;
  options.pupil_radius_mm =
      0.5 / camera.lens.image_f_number * (camera.lens.exit_pupil_mm > 0 ? camera.lens.exit_pupil_mm : 1);
  options.particle_radius_mm = kRadiusMm;
  options.diffraction_zero_um = first_zero_um;
  return options;
}

double sum_of(const std::vector<float>& values, std::size_t size) {
  return std::accumulate(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(size), 0.0);
}

TEST(GaussEdge, is_the_error_function_and_its_slope) {
  for (float t = -9; t <= 9; t += 0.013F) {
    const GaussEdge edge = gauss_edge(t);
    EXPECT_NEAR(edge.share, 0.5 * (1 + std::erf(static_cast<double>(t))), 3e-7) << t;
    EXPECT_NEAR(edge.bell, std::exp(-static_cast<double>(t) * t) / std::sqrt(std::numbers::pi), 3e-7) << t;
  }
}

TEST(DiffractionFilter, keeps_nine_tenths_of_the_light_in_few_pixels) {
  for (const double pixel_um : {2.0, 4.35, 9.0, 18.0, 50.0}) {
    const auto filter = diffraction_filter(15.96, pixel_um, 12);
    double sum = static_cast<double>(filter[0]);
    for (std::size_t i = 1; i < filter.size(); ++i) {
      sum += 2 * static_cast<double>(filter[i]);
      EXPECT_GE(filter[0], filter[i]);
    }
    EXPECT_GT(sum, 0.9) << pixel_um;
    EXPECT_LE(sum, 1.0 + 1e-6) << pixel_um;
  }
  EXPECT_EQ(diffraction_filter(0, 9, 12), std::vector<float>{1.0F});
}

TEST(ParticleImage, has_all_the_light_once) {
  const auto camera = small_camera();
  const LensletLattice lattice(camera);
  ImageModel model(camera, lattice, options_of(camera, 0));
  ParticleImage image(1 << 16);
  for (const double z : {-20.0, -7.0, -0.5, 0.0, 0.5, 4.0, 15.0}) {
    ASSERT_TRUE(model.render({0.11, -0.23, z}, image));
    EXPECT_NEAR(sum_of(image.value, image.size), 1, 0.01) << z;
    std::vector<std::uint32_t> pixels(image.pixel.begin(),
                                      image.pixel.begin() + static_cast<std::ptrdiff_t>(image.size));
    std::sort(pixels.begin(), pixels.end());
    EXPECT_EQ(std::adjacent_find(pixels.begin(), pixels.end()), pixels.end()) << "a pixel stands twice at z " << z;
  }
}

// χ² per pixel of a bright particle's traced image against the model.
double chi_square(const LightFieldCalibration& camera, double first_zero_um, const testing::ImageParticle& p) {
  constexpr int kPhotons = 20000;
  const LensletLattice lattice(camera);
  ImageModel model(camera, lattice, options_of(camera, first_zero_um));
  ParticleImage image(1 << 16);
  TracedImage traced(camera, 5);
  traced.add(p, kRadiusMm, kPhotons, first_zero_um);
  if (!model.render({p.x, p.y, p.z}, image)) return 1e9;
  double sum = 0;
  for (std::size_t i = 0; i < image.size; ++i) {
    const double expected = kPhotons * static_cast<double>(image.value[i]);
    sum += std::pow(traced.photons()[image.pixel[i]] - expected, 2) / (expected + 4);
  }
  return sum / static_cast<double>(image.size);
}

TEST(ParticleImage, is_what_photons_make_of_a_particle) {
  for (const double z : {-18.0, -6.0, -1.0, 0.0, 1.0, 5.0, 14.0}) {
    EXPECT_LT(chi_square(small_camera(), 0, {0.2, 0.1, z}), 2.0) << "sharp, z " << z;
    EXPECT_LT(chi_square(small_camera(), 15.96, {0.2, 0.1, z}), 2.0) << "diffracting, z " << z;
  }
  auto telecentric = small_camera();
  telecentric.lens.model = "telecentric", telecentric.lens.exit_pupil_mm = 0, telecentric.lens.magnification = 20;
  telecentric.lens.image_f_number = 20;  // sub-images overlap
  EXPECT_LT(chi_square(telecentric, 15.96, {0.2, 0.1, 9}), 2.0);
}

void expect_right_derivatives(const LightFieldCalibration& camera, double within) {
  const LensletLattice lattice(camera);
  ImageModel model(camera, lattice, options_of(camera, 15.96));
  ParticleImage at(1 << 16), low(1 << 16), high(1 << 16);
  for (const double z : {-19.0, -6.0, 0.4, 7.0, 14.0}) {
    const ImagePoint p{0.31, -0.17, z};
    ASSERT_TRUE(model.render(p, at));
    for (int k = 0; k < 3; ++k) {
      const double h = k < 2 ? 5e-4 : 1e-2;
      const auto moved = [&](double by) {
        return ImagePoint{p.x + (k == 0 ? by : 0), p.y + (k == 1 ? by : 0), p.z + (k == 2 ? by : 0)};
      };
      ASSERT_TRUE(model.render(moved(-h), low) && model.render(moved(h), high));
      std::map<std::uint32_t, double> numeric;
      for (std::size_t i = 0; i < low.size; ++i) numeric[low.pixel[i]] -= static_cast<double>(low.value[i]) / (2 * h);
      for (std::size_t i = 0; i < high.size; ++i)
        numeric[high.pixel[i]] += static_cast<double>(high.value[i]) / (2 * h);
      const auto& analytic = k == 0 ? at.dx : k == 1 ? at.dy : at.dz;
      double error = 0, square = 0;
      for (std::size_t i = 0; i < at.size; ++i) {
        error += std::pow(static_cast<double>(analytic[i]) - numeric[at.pixel[i]], 2);
        square += std::pow(static_cast<double>(analytic[i]), 2);
      }
      EXPECT_LT(std::sqrt(error / square), within) << "axis " << k << ", z " << z;  // faint pixels come and go
    }
  }
}

TEST(ParticleImage, knows_its_derivatives) { expect_right_derivatives(small_camera(), 0.1); }

TEST(ParticleImage, knows_its_derivatives_behind_rims_that_cut_the_pupil) {
  auto camera = small_camera();
  const LensletLattice lattice(camera);
  ParticleImage whole(1 << 16), cut(1 << 16);
  ASSERT_TRUE(ImageModel(camera, lattice, options_of(camera, 15.96)).render({0.31, -0.17, 7}, whole));
  camera.lens.rim_shift = {-0.4, 0.3}, camera.lens.rim_radius_mm = {1.0, 1.2};
  ASSERT_TRUE(ImageModel(camera, lattice, options_of(camera, 15.96)).render({0.31, -0.17, 7}, cut));
  EXPECT_LT(cut.size, 0.8 * static_cast<double>(whole.size));
  expect_right_derivatives(camera, 0.25);  // rims cut most of what shows the depth
}

TEST(ParticleImage, is_empty_off_the_sensor_and_where_there_is_no_room) {
  const auto camera = small_camera();
  const LensletLattice lattice(camera);
  ImageModel model(camera, lattice, options_of(camera, 0));
  ParticleImage image(1 << 16), small(100);
  EXPECT_FALSE(model.render({50, 0, 1}, image));
  EXPECT_FALSE(model.render({0, 0, 80}, image));
  EXPECT_FALSE(model.render({0, 0, 12}, small));
  ASSERT_TRUE(model.render({2.25, 0, 3}, image));  // at the border: a part is seen
  EXPECT_LT(sum_of(image.value, image.size), 0.95);
}

}  // namespace
}  // namespace rptv
