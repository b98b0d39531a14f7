// SPDX-License-Identifier: MIT
// Particle images that overlap: told apart, in the right place, with errors that still are what they say.
#include <gtest/gtest.h>

#include "reconstruct/detection/detector.hpp"
#include "tests/core/allocation_counter.hpp"
#include "tests/reconstruct/detection/spot_score.hpp"

namespace rptv {
namespace {

using testing::PaintedSpot;
using testing::SpotImage;

constexpr ImageShape kShape{400, 400, 1}, kDense{256, 256, 1};

DetectorSettings settings_with(std::int64_t sweeps) {
  const testing::Camera camera;
  DetectorSettings settings;
  settings.background = camera.background, settings.noise_grey = camera.noise_grey, settings.threshold = 12;
  settings.electrons_per_grey = camera.electrons_per_grey, settings.overlap_sweeps = sweeps;
  settings.find_hidden = true, settings.max_detections = 4096;
  return settings;
}

testing::SpotScore score_of(const DetectorSettings& settings, const std::vector<PaintedSpot>& spots, std::uint32_t seed,
                            const ImageShape& shape = kShape) {
  testing::Camera camera;
  camera.shape = shape;
  std::mt19937 random(seed);
  Detector detector(settings, shape);
  Detections found(16384);
  detector.detect(SpotImage(camera, spots, random).view(), found);
  return testing::score_spots(found, spots, 1);
}

// Pairs at all angles, `apart_px` from each other, of different brightness.
std::vector<PaintedSpot> pairs(double apart_px, double sigma_px) {
  std::vector<PaintedSpot> spots;
  for (int k = 0; k < 121; ++k) {
    const double x = 26 + 34 * (k % 11) + 0.01 * k, y = 26 + 34 * (k / 11), angle = 0.19 * k;
    spots.push_back({x, y, sigma_px, 150});
    spots.push_back({x + apart_px * std::cos(angle), y + apart_px * std::sin(angle), sigma_px, 110});
  }
  return spots;
}

TEST(SpotOverlaps, do_not_pull_the_centres_of_a_pair) {
  for (const double apart_px : {3.5, 4.5, 6.0}) {
    const auto tangled = score_of(settings_with(0), pairs(apart_px, 1.3), 3);
    const auto untangled = score_of(settings_with(12), pairs(apart_px, 1.3), 3);
    SCOPED_TRACE(std::to_string(apart_px) + " px");
    EXPECT_GE(untangled.pairs, 236U);
    EXPECT_GE(untangled.precision(), 0.99);
    EXPECT_LE(untangled.rms_px, tangled.rms_px);
    EXPECT_LT(untangled.rms_px, 0.06);
    EXPECT_GT(untangled.normalised_variance, 0.6);
    EXPECT_LT(untangled.normalised_variance, 2.5);
  }
}

TEST(SpotOverlaps, let_those_be_found_that_make_no_maximum_of_their_own) {
  const auto tangled = score_of(settings_with(0), pairs(2.8, 1.3), 5);
  const auto untangled = score_of(settings_with(12), pairs(2.8, 1.3), 5);
  EXPECT_LT(tangled.recall(), 0.85);
  EXPECT_GT(untangled.recall(), 0.97);
  EXPECT_GT(untangled.precision(), 0.97);
}

TEST(SpotOverlaps, are_untangled_in_dense_images) {
  std::mt19937 random(7);
  const auto spots = testing::scatter_spots(kDense, 1600, 0, 4, 1, 150, random);  // 0.025 a pixel
  const auto tangled = score_of(settings_with(0), spots, 1, kDense);
  const auto untangled = score_of(settings_with(6), spots, 1, kDense);
  EXPECT_GT(untangled.recall(), tangled.recall() + 0.1);
  EXPECT_GT(untangled.recall(), 0.75);
  EXPECT_GT(untangled.precision(), 0.95);
  EXPECT_LT(untangled.rms_px, tangled.rms_px);
}

TEST(SpotOverlaps, beyond_the_limit_are_left_and_counted_and_cost_no_allocation) {
  testing::Camera camera;
  camera.shape = kDense;
  std::mt19937 random(9);
  const auto spots = testing::scatter_spots(kDense, 1600, 0, 4, 1, 150, random);
  const SpotImage image(camera, spots, random);
  auto settings = settings_with(2);
  Detections found(16384), as_without(16384);
  Detector(settings_with(0), kDense).detect(image.view(), as_without);
  settings.max_overlapping = 100;
  Detector limited(settings, kDense);
  limited.detect(image.view(), found);
  EXPECT_GT(limited.counts().too_crowded, 500U);
  EXPECT_EQ(found.x_px, as_without.x_px);
  settings.max_overlapping = 10000;
  Detector detector(settings, kDense);
  AllocationCounter counter;
  detector.detect(image.view(), found);
  detector.detect(image.view(), as_without);
  counter.disarm();
  if (AllocationCounter::kCounts) {
    EXPECT_EQ(counter.allocations(), 0U);
  }
  EXPECT_EQ(found.x_px, as_without.x_px) << "something of the frame before is left";
  EXPECT_EQ(detector.counts().too_crowded, 0U);
}

TEST(SpotOverlaps, that_see_too_many_others_are_left_and_counted) {
  const testing::Camera camera{{100, 100, 2}, 10, 2, 4, 65535};
  std::vector<PaintedSpot> spots;  // light of each is seen 7 px away
  for (int k = 0; k < 900; ++k) spots.push_back({6.0 + 3 * (k % 30), 6.0 + 3 * (k / 30), 1.2, 40000});
  std::mt19937 random(1);
  const SpotImage image(camera, spots, random);
  auto settings = settings_with(0);
  settings.radius_px = 3, settings.max_overlapping = 900;
  Detections found(16384), as_without(16384);
  Detector(settings, camera.shape).detect(image.view(), as_without);
  settings.overlap_sweeps = 2;
  Detector detector(settings, camera.shape);
  detector.detect(image.view(), found);
  EXPECT_GT(found.size(), 800U);
  EXPECT_EQ(detector.counts().too_crowded, found.size());
  EXPECT_EQ(found.x_px, as_without.x_px);
  EXPECT_EQ(found.sigma_px, as_without.sigma_px);
}

}  // namespace
}  // namespace rptv
