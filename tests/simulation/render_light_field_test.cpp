// SPDX-License-Identifier: MIT
// Rendered images against geometry, photon counts and noise figures that are worked out here independently.
#include "simulation/render_light_field.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <thread>

namespace rptv {
namespace {

ScenarioSettings small_scene() {
  ScenarioSettings s;
  s.camera.width_px = 256;
  s.camera.height_px = 224;
  s.seeding.particles = 12;
  s.seeding.volume_x_mm = s.seeding.volume_y_mm = 1.2;
  s.flow.wall_y_mm = -0.6;
  s.flow.wall_amplitude_mm = 0;
  s.frames = 3;
  return s;
}

Tracer tracer_at(double x, double y, double z) { return {0, 0, {x, y, z}, {}}; }

struct Blob {
  double sum = 0, column = 0, row = 0;
};

/// Light and its centroid within `half` px of (column, row).
Blob blob_at(const LightFieldRenderer& renderer, double column, double row, int half) {
  Blob blob;
  const auto expected = renderer.expected();
  const long width = renderer.shape().width_px, height = renderer.shape().height_px;
  for (long j = std::max(0L, std::lround(row) - half); j <= std::min(height - 1, std::lround(row) + half); ++j)
    for (long i = std::max(0L, std::lround(column) - half); i <= std::min(width - 1, std::lround(column) + half); ++i) {
      const double v = static_cast<double>(expected[static_cast<std::size_t>(j * width + i)]);
      blob.sum += v;
      blob.column += v * static_cast<double>(i);
      blob.row += v * static_cast<double>(j);
    }
  blob.column /= blob.sum;
  blob.row /= blob.sum;
  return blob;
}

TEST(LightFieldOptics, images_by_the_thick_lens_with_its_sign) {
  const LightFieldOptics optics{ScenarioSettings{}};
  EXPECT_NEAR(optics.array_distance_mm(), 87.5, 1e-12);  // 1/25 = 1/35 + 1/87.5
  EXPECT_NEAR(optics.magnification(0), 2.5, 1e-12);
  const auto image = optics.image_of({1.0, -2.0, 3.5});  // s = 31.5: s' = 787.5 / 6.5
  const double s_image = 787.5 / 6.5;
  EXPECT_NEAR(image.x, -s_image / 31.5, 1e-12);
  EXPECT_NEAR(image.y, 2.0 * s_image / 31.5, 1e-12);
  EXPECT_NEAR(image.z, 87.5 - s_image, 1e-12);  // behind the array: away from the lens
}

TEST(LightFieldOptics, images_the_entrance_pupil_into_the_exit_pupil) {
  ScenarioSettings s;
  s.main_lens.f_number = 8.5;
  const LightFieldOptics optics(s);
  EXPECT_NEAR(optics.exit_pupil_mm(), 84.82142857142857, 1e-9);  // as a ray trace of the same lens states
  EXPECT_NEAR(optics.exit_pupil_radius_mm(), 1.3130252100840338, 1e-9);
}

TEST(LightFieldOptics, finds_every_lenslet_at_its_own_centre) {
  const LightFieldOptics optics{ScenarioSettings{}};
  for (long v = -40; v <= 40; v += 5)
    for (long u = -40; u <= 40; u += 5) {
      const auto centre = optics.lenslet_centre({u, v});
      EXPECT_EQ(optics.lenslet_at(centre[0] + 0.05, centre[1] - 0.05), (std::array<long, 2>{u, v}));
    }
}

TEST(LightFieldOptics, hands_the_reconstruction_the_same_camera) {
  const ScenarioSettings scenario;
  const LightFieldOptics optics(scenario);
  LightFieldCalibration calibration = optics.calibration();
  FieldList list;
  calibration.fields(list);
  const auto read = parse_light_field_calibration(to_toml(list, LightFieldCalibration::kSchema), "calibration.toml");
  EXPECT_NEAR(read.magnification(), 2.5, 1e-12);
  EXPECT_NEAR(read.apparent_scale(), 1 + 3.75 / optics.exit_pupil_mm(), 1e-12);
  EXPECT_LT(read.subimage_overlap(), 1.0);
  EXPECT_TRUE(read.warnings().empty());
}

TEST(LightFieldRenderer, puts_each_subimage_where_the_ray_through_its_lenslet_lands) {
  ScenarioSettings s = small_scene();
  s.seeding.particle_radius_um = 1;
  s.rays_per_particle = 40000;
  LightFieldRenderer renderer(s);
  std::vector<std::byte> pixels(renderer.shape().bytes());
  const Vector3 object{0.11, -0.07, 3.0};
  const std::vector<Tracer> one{tracer_at(object.x, object.y, object.z)};
  renderer.render(one, 0, pixels);
  const auto& optics = renderer.optics();
  const auto image = optics.image_of(object);
  ASSERT_LT(image.z, -20);
  const auto middle = optics.lenslet_at(image.x, image.y);
  int tested = 0;
  for (long dv = -1; dv <= 1; ++dv)
    for (long du = -1; du <= 1; ++du) {
      const auto c = optics.lenslet_centre({middle[0] + du, middle[1] + dv});
      const double chief = optics.exit_pupil_mm() / (optics.exit_pupil_mm() - image.z);  // pupil (0, 0) to the array
      const double cone = optics.exit_pupil_radius_mm() * -image.z / (optics.exit_pupil_mm() - image.z);
      const double off = std::hypot(c[0] - chief * image.x, c[1] - chief * image.y);
      if (off + s.lenslets.pitch_mm * M_SQRT1_2 > cone) continue;  // lenslet not wholly inside the cone of light
      // The mean slope is that of the ray image point - lenslet centre: p = c + f (c - X) / (0 - z).
      const double f = s.lenslets.focal_length_mm;
      const double px = c[0] + f * (image.x - c[0]) / -image.z, py = c[1] + f * (image.y - c[1]) / -image.z;
      const double pixel = s.camera.pixel_um * 1e-3;
      const auto blob = blob_at(renderer, px / pixel + 127.5, py / pixel + 111.5, 3);
      EXPECT_NEAR(blob.column, px / pixel + 127.5, 0.06) << du << ' ' << dv;
      EXPECT_NEAR(blob.row, py / pixel + 111.5, 0.06) << du << ' ' << dv;
      ++tested;
    }
  EXPECT_GE(tested, 4);
}

TEST(LightFieldRenderer, spends_the_photon_budget_and_no_more) {
  ScenarioSettings s = small_scene();
  LightFieldRenderer renderer(s);
  std::vector<std::byte> pixels(renderer.shape().bytes());
  for (const double z : {-3.0, 0.0, 3.0}) {
    const std::vector<Tracer> one{tracer_at(0.02, 0.03, z)};
    ASSERT_TRUE(renderer.in_view(one[0].position));
    renderer.render(one, 0, pixels);
    double sum = 0;
    for (const float v : renderer.expected()) sum += static_cast<double>(v);
    const double distance = 38.0 / (38.0 - z);  // to the entrance pupil
    EXPECT_NEAR(sum, s.seeding.photoelectrons * distance * distance, 1e-3 * s.seeding.photoelectrons);
  }
}

TEST(LightFieldRenderer, knows_which_particles_are_fully_in_view) {
  ScenarioSettings s = small_scene();
  LightFieldRenderer renderer(s);
  std::vector<std::byte> pixels(renderer.shape().bytes());
  int in_view = 0, cut = 0;
  for (double x = 0.3; x < 1.1; x += 0.02)
    for (const double z : {-3.0, 0.0, 3.0}) {
      const std::vector<Tracer> one{tracer_at(x, 0, z)};
      renderer.render(one, 0, pixels);
      double sum = 0;
      for (const float v : renderer.expected()) sum += static_cast<double>(v);
      const double whole = s.seeding.photoelectrons * renderer.optics().brightness(z);
      if (renderer.in_view(one[0].position)) {
        ++in_view;
        EXPECT_GT(sum, 0.985 * whole) << x << ' ' << z;  // diffraction's tail may cross the border
      } else if (sum < 0.9 * whole) {
        ++cut;
      }
    }
  EXPECT_GT(in_view, 20);
  EXPECT_GT(cut, 20);
}

TEST(LightFieldRenderer, centres_white_spots_on_the_apparent_lattice) {
  ScenarioSettings s = small_scene();
  s.lenslets.rotation_deg = 1.3;
  LightFieldRenderer renderer(s);
  std::vector<std::byte> pixels(renderer.shape().bytes());
  renderer.render_white(0.6, pixels);
  int tested = 0;
  for (long v = -10; v <= 10; v += 4)
    for (long u = -12; u <= 12; u += 4) {
      const auto spot = renderer.optics().white_spot({u, v});
      if (spot.column < 6 || spot.row < 6 || spot.column > 249 || spot.row > 217) continue;
      // A window of whole pixels cuts the neighbours unevenly: a quarter of a pixel is what it can tell.
      const auto blob = blob_at(renderer, spot.column, spot.row, 3);
      EXPECT_NEAR(blob.column, spot.column, 0.25);
      EXPECT_NEAR(blob.row, spot.row, 0.25);
      ++tested;
    }
  EXPECT_GT(tested, 20);
}

TEST(LightFieldRenderer, has_shot_and_read_noise_of_the_stated_size) {
  ScenarioSettings s = small_scene();
  s.seeding.particles = 0;
  s.camera.background_e = 600;
  s.camera.gain_e_per_dn = 2.5;
  s.camera.read_noise_e = 20;
  LightFieldRenderer renderer(s);
  std::vector<std::uint16_t> pixels(renderer.shape().pixels());
  renderer.render({}, 5, std::as_writable_bytes(std::span(pixels)));
  double sum = 0, square = 0;
  for (const auto v : pixels) sum += v;
  const double mean = sum / static_cast<double>(pixels.size());
  for (const auto v : pixels) square += (v - mean) * (v - mean);
  const double variance = square / static_cast<double>(pixels.size());
  EXPECT_NEAR(mean, 32 + 600 / 2.5, 0.2);
  EXPECT_NEAR(variance, (600 + 20 * 20) / (2.5 * 2.5) + 1.0 / 12, 0.02 * 160);
}

TEST(LightFieldRenderer, clips_at_full_scale_of_8_and_12_bits) {
  for (const int bits : {8, 12}) {
    ScenarioSettings s = small_scene();
    s.camera.bits = bits;
    s.seeding.photoelectrons = 1e7;
    LightFieldRenderer renderer(s);
    std::vector<std::byte> pixels(renderer.shape().bytes());
    const std::vector<Tracer> one{tracer_at(0, 0, 0)};
    renderer.render(one, 0, pixels);
    const ImageView view{pixels.data(), renderer.shape()};
    unsigned maximum = 0;
    for (std::size_t i = 0; i < renderer.shape().pixels(); ++i)
      maximum = std::max<unsigned>(maximum, bits == 8 ? view.as_u8()[i] : view.as_u16()[i]);
    EXPECT_EQ(renderer.shape().bytes_per_pixel, bits == 8 ? 1U : 2U);
    EXPECT_EQ(maximum, (1U << bits) - 1);
  }
}

TEST(LightFieldRenderer, draws_a_frame_the_same_in_any_thread_and_order) {
  const ScenarioSettings s = small_scene();
  const Tracers tracers(s);
  std::vector<std::vector<std::byte>> in_order, threaded(3);
  LightFieldRenderer renderer(s);
  for (std::uint64_t frame = 0; frame < 3; ++frame) {
    in_order.emplace_back(renderer.shape().bytes());
    renderer.render(tracers.lit(frame), frame, in_order.back());
  }
  std::vector<std::thread> threads;
  for (const std::uint64_t frame : {2U, 0U, 1U})
    threads.emplace_back([&, frame] {
      LightFieldRenderer own(s);
      threaded[frame].resize(own.shape().bytes());
      own.render(tracers.lit(frame), frame, threaded[frame]);
    });
  for (auto& thread : threads) thread.join();
  EXPECT_EQ(in_order, threaded);
  EXPECT_NE(in_order[0], in_order[1]);  // other noise in every frame
}

TEST(LightFieldRenderer, makes_other_images_from_another_seed) {
  ScenarioSettings s = small_scene();
  LightFieldRenderer first(s);
  s.seed = 2;
  LightFieldRenderer second(s);
  std::vector<std::byte> a(first.shape().bytes()), b(first.shape().bytes());
  first.render({}, 0, a);
  second.render({}, 0, b);
  EXPECT_NE(a, b);
}

}  // namespace
}  // namespace rptv
