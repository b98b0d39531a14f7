// SPDX-License-Identifier: MIT
// The tracer against what is known in closed form: Snell, spheres, Cartesian conics, and the paraxial limit.
#include "simulation/lens_tracer.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "simulation/lens_analysis.hpp"

namespace rptv {
namespace {

const std::filesystem::path kShipped = std::filesystem::path(RPTV_SOURCE_DIR) / "simulation" / "prescriptions";

Prescription lens_of(std::vector<LensSurface> surfaces) {
  Prescription lens;
  lens.surfaces = std::move(surfaces);
  return lens;
}

LensRay tilted(double x, double y, double z, double slope_x, double slope_y) {
  const double scale = 1 / std::sqrt(1 + slope_x * slope_x + slope_y * slope_y);
  return {x, y, z, slope_x * scale, slope_y * scale, scale};
}

/// Height of the ray at a plane behind the lens.
double height_at(const LensRay& ray, double z) { return ray.x + ray.l / ray.n * (z - ray.z); }

TEST(LensTracer, refracts_at_a_plane_by_snells_law) {
  const LensTracer tracer(lens_of({{0, 0, 0, 1.5, 0}}), 0, {});
  for (const double degrees : {0.0, 10.0, 35.0, 60.0, 89.0}) {
    const double sine = std::sin(degrees * M_PI / 180);
    LensRay ray{0, 0, -1, 0.6 * sine, 0.8 * sine, std::sqrt(1 - sine * sine)};
    ASSERT_TRUE(tracer.forward(ray));
    EXPECT_NEAR(std::hypot(ray.l, ray.m), sine / 1.5, 1e-14);
    EXPECT_NEAR(ray.l / 0.6, ray.m / 0.8, 1e-14);  // in the plane of incidence
    EXPECT_NEAR(ray.l * ray.l + ray.m * ray.m + ray.n * ray.n, 1, 1e-14);
  }
}

TEST(LensTracer, loses_light_beyond_the_critical_angle) {
  const LensTracer tracer(lens_of({{0, 0, 1, 1.5, 0}, {0, 0, 0, 1, 0}}), 0, {});
  LensRay inside = tilted(0, 0, -1, 0.5, 0);
  EXPECT_TRUE(tracer.forward(inside));  // in through a plane, out through a parallel one: always
  const LensTracer steep(lens_of({{0, 0, 5, 1.8, 0}, {-6, 0, 0, 1, 0}}), 0, {});
  LensRay low = tilted(1, 0, -1, 0, 0), high = tilted(4, 0, -1, 0, 0);  // sin i = h/6; critical 1/1.8 = 0.556
  EXPECT_TRUE(steep.forward(low));
  EXPECT_FALSE(steep.forward(high));
}

TEST(LensTracer, crosses_the_axis_behind_a_sphere_where_trigonometry_says) {
  const double radius = 30, index = 1.6;
  const LensTracer tracer(lens_of({{radius, 0, 0, index, 0}}), 0, {});
  for (const double height : {1e-4, 1.0, 5.0, 12.0}) {
    LensRay ray = tilted(height, 0, -10, 0, 0);
    ASSERT_TRUE(tracer.forward(ray));
    const double i = std::asin(height / radius), t = std::asin(height / radius / index);
    const double crossing = radius + radius * std::sin(t) / std::sin(i - t);  // law of sines about the centre
    EXPECT_NEAR(ray.z - ray.x * ray.n / ray.l, crossing, 1e-8 * crossing);
  }
}

TEST(LensTracer, forms_a_perfect_image_at_an_ellipsoid) {  // Descartes: k = -1/n^2 from air into glass
  const double radius = 20, index = 1.5, focus = index * radius / (index - 1);
  const LensTracer tracer(lens_of({{radius, -1 / (index * index), 0, index, 0}}), 0, {});
  for (double height = 0.5; height < 14; height += 1.5) {
    LensRay ray = tilted(height, 0.3 * height, -5, 0, 0);
    ASSERT_TRUE(tracer.forward(ray));
    EXPECT_NEAR(height_at(ray, focus), 0, 1e-12 * focus);
  }
  const LensTracer sphere(lens_of({{radius, 0, 0, index, 0}}), 0, {});
  LensRay marginal = tilted(10, 0, -5, 0, 0);
  ASSERT_TRUE(sphere.forward(marginal));
  EXPECT_LT(height_at(marginal, focus), -0.5);  // and a sphere does not
}

TEST(LensTracer, forms_a_perfect_image_at_a_hyperboloid) {  // k = -n^2 from glass into air
  const double radius = -12, index = 1.5, thickness = 8, focus = thickness + radius / (1 - index);
  const LensTracer tracer(lens_of({{0, 0, thickness, index, 0}, {radius, -index * index, 0, 1, 0}}), 0, {});
  for (double height = 0.5; height < 12; height += 1.5) {
    LensRay ray = tilted(height, -0.7 * height, -5, 0, 0);
    ASSERT_TRUE(tracer.forward(ray));
    EXPECT_NEAR(height_at(ray, focus), 0, 1e-11);
  }
}

TEST(LensTracer, comes_back_on_its_own_path) {
  const LensTracer tracer(read_prescription(kShipped / "double_gauss_f2.toml"), 0, {});
  for (const double x : {-6.0, 0.0, 4.0})
    for (const double slope : {-0.1, 0.0, 0.15}) {
      const LensRay start = tilted(x, 2.0, -3, slope, 0.05);
      LensRay ray = start;
      ASSERT_TRUE(tracer.forward(ray));
      LensRay back{ray.x + 7 * ray.l, ray.y + 7 * ray.m, ray.z + 7 * ray.n, -ray.l, -ray.m, -ray.n};
      ASSERT_TRUE(tracer.backward(back));
      EXPECT_NEAR(back.l, -start.l, 1e-13);
      EXPECT_NEAR(back.m, -start.m, 1e-13);
      EXPECT_NEAR(back.x + back.l / back.n * (start.z - back.z), start.x, 1e-11);
    }
}

TEST(LensTracer, traces_many_rays_as_it_traces_one) {
  const LensTracer tracer(read_prescription(kShipped / "macro_25mm_f28.toml"), 0, {});
  std::vector<LensRay> rays;
  for (int i = 0; i < 101; ++i)
    rays.push_back(tilted(0.4 * (i % 11 - 5), 0.3 * (i / 11 - 4), -30, 0.12 * (i % 7 - 3), 0.05 * (i % 5)));
  std::vector<LensRay> together = rays;
  tracer.forward(together);
  int passed = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const bool through = tracer.forward(rays[i]);
    ASSERT_EQ(together[i].n != 0, through) << i;
    if (!through) continue;
    ++passed;
    EXPECT_EQ(together[i].x, rays[i].x);
    EXPECT_EQ(together[i].m, rays[i].m);
    EXPECT_EQ(together[i].n, rays[i].n);
  }
  EXPECT_GT(passed, 10);
  EXPECT_LT(passed, 101);
}

TEST(LensTracer, agrees_with_the_paraxial_figures_near_the_axis) {
  for (const auto* name : {"double_gauss_f2.toml", "macro_25mm_f28.toml"}) {
    const Prescription lens = read_prescription(kShipped / name);
    const LensAnalysis figures = analyse(lens);
    const LensTracer tracer(lens, 0, {});
    LensRay parallel = tilted(1e-4, 0, -1, 0, 0);
    ASSERT_TRUE(tracer.forward(parallel));
    EXPECT_NEAR(parallel.z - parallel.x * parallel.n / parallel.l, figures.f2_z_mm, 1e-5);
    EXPECT_NEAR(-1e-4 * parallel.n / parallel.l, figures.efl_mm, 1e-5);
    const LensConjugates plane = conjugates_of_magnification(figures, 1.7);
    for (const double slope : {-1e-5, 1e-5}) {
      LensRay ray = tilted(1e-4, 0, figures.h1_z_mm - plane.object_mm, slope, 0);
      ASSERT_TRUE(tracer.forward(ray));
      EXPECT_NEAR(height_at(ray, figures.h2_z_mm + plane.image_mm), -1.7e-4, 1e-10) << name;
    }
  }
}

TEST(LensTracer, aims_at_the_stop_through_the_entrance_pupil) {
  const LensAnalysis figures = analyse(read_prescription(kShipped / "double_gauss_f2.toml"), 1.063);
  const LensTracer tracer(read_prescription(kShipped / "double_gauss_f2.toml"), 1.063, {});
  const double distance = figures.entrance_pupil_z_mm + 77.5;  // from a point on the axis to the pupil's rim
  const LensRay ray = tilted(0, 0, -77.5, figures.entrance_pupil_radius_mm / distance, 0);
  EXPECT_NEAR(tracer.height_at_stop(ray), 1.063, 2e-3);  // pupil aberration
  EXPECT_NEAR(tracer.height_at_stop(tilted(0, 0, -77.5, 1e-6, 0)) / 1e-6,
              1.063 / (figures.entrance_pupil_radius_mm / distance), 1e-3);
}

TEST(LensTracer, stops_at_stop_and_rims_and_nowhere_else) {
  Prescription lens = lens_of({{0, 0, 10, 1, 0}, {0, 0, 10, 1, 2}, {0, 0, 0, 1, 4}});
  lens.stop = 1;
  const std::vector<Rim> hood{{-5, 1.5}, {15, 1.8}, {40, 1.9}};
  const auto passes = [](const LensTracer& tracer, double x, double y) {
    LensRay ray{x, y, -20, 0, 0, 1}, back{x, y, 90, 0, 0, -1};
    const bool ahead = tracer.forward(ray);
    EXPECT_EQ(tracer.backward(back), ahead);
    return ahead;
  };
  EXPECT_TRUE(passes(LensTracer(lens, 0, {}), 1.99, 0));
  EXPECT_FALSE(passes(LensTracer(lens, 0, {}), 1.5, 1.5));
  EXPECT_FALSE(passes(LensTracer(lens, 0.5, {}), 0.51, 0));
  EXPECT_TRUE(passes(LensTracer(lens, 0, hood), 0, 1.49));
  EXPECT_FALSE(passes(LensTracer(lens, 0, hood), 0, 1.51));
  EXPECT_TRUE(passes(LensTracer(lens, 0, std::span(hood).subspan(1)), 0, 1.79));
  EXPECT_FALSE(passes(LensTracer(lens, 0, std::span(hood).subspan(1)), 0, 1.81));
}

TEST(LensTracer, misses_a_sphere_beside_it) {
  const LensTracer tracer(lens_of({{5, 0, 0, 1.5, 0}}), 0, {});
  LensRay ray = tilted(5.1, 0, -1, 0, 0);
  EXPECT_FALSE(tracer.forward(ray));
}

}  // namespace
}  // namespace rptv
