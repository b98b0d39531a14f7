// SPDX-License-Identifier: MIT
// Images of a small rig's views, made of the model of a particle image in double precision, with or without noise.
#pragma once

#include <algorithm>
#include <random>

#include "calibration/space_algebra.hpp"
#include "reconstruct/multi_view/shaken_particles.hpp"
#include "tests/reconstruct/multi_view/plain_spot.hpp"

namespace rptv::testing {

/// Four pinholes 600 mm from the origin, ±30° about y and ±10° about x, 160 x 128 px, 16.7 px/mm: they see a box of
/// 6 x 5 x 4 mm whole.
inline std::vector<CameraModel> small_rig() {
  std::vector<CameraModel> models;
  for (const double a : {-0.52, 0.52})
    for (const double b : {-0.17, 0.17}) {
      const Point3 from{std::sin(a) * std::cos(b), std::sin(b), std::cos(a) * std::cos(b)}, forward = -1.0 * from;
      const Point3 beside = cross({0, -1, 0}, forward), right = (1 / norm(beside)) * beside;
      models.emplace_back(CameraIntrinsics{160, 128, 10000, 10000, 79.5, 63.5},
                          CameraPose{{{right, cross(forward, right), forward}}, {0, 0, 600}});
    }
  return models;
}

inline constexpr ImageShape kSmallShape{160, 128, 2};
inline constexpr Volume kSmallVolume{{-3, -2.5, -2}, {3, 2.5, 2}};
inline constexpr double kSmallSigma_px = 0.7;

/// At least 0.15 mm (2.5 px) apart; their images overlap all the same, but not in every view.
inline std::vector<Point3> random_places(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> part(0.05, 0.95);
  std::vector<Point3> places;
  while (places.size() < count) {
    Point3 place;
    for (std::size_t k = 0; k < 3; ++k)
      place[k] = kSmallVolume.from[k] + part(random) * (kSmallVolume.to[k] - kSmallVolume.from[k]);
    if (std::none_of(places.begin(), places.end(), [&](const Point3& other) { return norm(place - other) < 0.15; }))
      places.push_back(place);
  }
  return places;
}

/// 16-bit pixels of one view over a background of 100; each particle has `grey`, each pixel Gaussian noise.
inline std::vector<std::uint16_t> paint_view(const CameraModel& model, const std::vector<Point3>& places, double grey,
                                             double noise_grey, unsigned seed) {
  std::vector<ViewSpot> spots;
  for (const Point3& place : places) {
    const Pixel pixel = *model.project(place);
    spots.push_back({static_cast<float>(pixel[0]), static_cast<float>(pixel[1]), static_cast<float>(kSmallSigma_px),
                     static_cast<float>(grey)});
  }
  std::vector<double> light(kSmallShape.pixels(), 100);
  add_plain_spots(spots, 160, 128, light);
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, noise_grey > 0 ? noise_grey : 1);
  std::vector<std::uint16_t> pixels;
  for (const double value : light)
    pixels.push_back(static_cast<std::uint16_t>(std::lround(value + (noise_grey > 0 ? noise(random) : 0))));
  return pixels;
}

/// Views of the small rig that have such images loaded, and no particles yet.
inline ShakenParticles painted_particles(const std::vector<Point3>& places, double grey, double noise_grey,
                                         std::size_t threads = 1) {
  std::vector<ResidualView> views;
  const auto models = small_rig();
  const DarkPixels dark = make_dark({100, 10, ""}, kSmallShape, {});
  for (std::size_t v = 0; v < models.size(); ++v) {
    views.emplace_back(kSmallShape, GreyNoise{static_cast<float>(noise_grey * noise_grey + 1.0 / 12), 0}, 0);
    const auto pixels = paint_view(models[v], places, grey, noise_grey, static_cast<unsigned>(v));
    views.back().load({reinterpret_cast<const std::byte*>(pixels.data()), kSmallShape}, dark);
  }
  return {models, std::move(views), kSmallVolume, {2 * places.size(), threads, kSmallSigma_px}};
}

}  // namespace rptv::testing
