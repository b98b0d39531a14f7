// SPDX-License-Identifier: MIT
// Frames to particle images: found, in the right place, with errors that are what they say.
#include "reconstruct/detection/detector.hpp"

#include <gtest/gtest.h>

#include "core/error.hpp"
#include "tests/core/allocation_counter.hpp"
#include "tests/core/instruction_sets.hpp"
#include "tests/reconstruct/detection/painted_spots.hpp"
#include "tests/reconstruct/detection/spot_score.hpp"

namespace rptv {
namespace {

using testing::PaintedSpot;
using testing::SpotImage;

DetectorSettings settings_for(const testing::Camera& camera, const std::string& method = "gaussian") {
  DetectorSettings settings;
  settings.background = camera.background, settings.noise_grey = camera.noise_grey;
  settings.electrons_per_grey = camera.electrons_per_grey, settings.method = method;
  settings.max_detections = 4096;
  return settings;
}

testing::SpotScore score_of(const DetectorSettings& settings, const testing::Camera& camera, double sigma_px,
                            double peak) {
  Detector detector(settings, camera.shape);
  Detections found(4096);
  std::mt19937 random(7);
  constexpr int kImages = 4;
  testing::SpotScore total;
  for (int image = 0; image < kImages; ++image) {
    const auto spots = testing::scatter_spots(camera.shape, 100, 12, 6, sigma_px, peak, random);
    detector.detect(SpotImage(camera, spots, random).view(), found);
    const auto score = testing::score_spots(found, spots, 1);
    total.painted += score.painted, total.found += score.found, total.pairs += score.pairs;
    total.normalised_variance += score.normalised_variance / kImages, total.rms_px += score.rms_px / kImages;
  }
  return total;
}

TEST(Detector, finds_every_spot_once_with_errors_that_are_what_they_say) {
  for (const double sigma_px : {0.9, 1.3, 1.8})
    for (const double peak : {60.0, 200.0}) {
      const testing::Camera camera;
      const auto score = score_of(settings_for(camera), camera, sigma_px, peak);
      SCOPED_TRACE(std::to_string(sigma_px) + " px, " + std::to_string(peak));
      EXPECT_EQ(score.pairs, score.painted);
      EXPECT_EQ(score.found, score.painted);
      EXPECT_NEAR(score.normalised_variance, 1, 0.25);
    }
}

TEST(Detector, tells_honest_errors_by_three_points_and_by_the_centre_of_light_too) {
  const testing::Camera camera;
  const auto three_point = score_of(settings_for(camera, "three_point"), camera, 1, 200);
  EXPECT_EQ(three_point.pairs, three_point.painted);
  EXPECT_NEAR(three_point.normalised_variance, 1, 0.25);
  auto wide = settings_for(camera, "centroid");
  wide.radius_px = 3;
  const auto centroid = score_of(wide, camera, 1, 200);
  EXPECT_EQ(centroid.pairs, centroid.painted);
  EXPECT_NEAR(centroid.normalised_variance, 1, 0.25);
}

TEST(Detector, works_alike_at_10_12_and_16_bit) {
  for (const double highest : {1023.0, 4095.0, 65535.0}) {
    const double scale = highest / 255;
    const testing::Camera camera{{256, 256, 2}, 10 * scale, 2 * scale, 4 / scale, highest};
    auto settings = settings_for(camera);
    settings.threshold = 12 * scale, settings.saturation_grey = highest;
    const auto score = score_of(settings, camera, 1.3, 150 * scale);
    EXPECT_EQ(score.pairs, score.painted);
    EXPECT_EQ(score.found, score.painted);
    EXPECT_NEAR(score.normalised_variance, 1, 0.25);
  }
}

TEST(Detector, finds_the_middle_of_saturated_spots) {
  const testing::Camera camera;
  for (const double sigma_px : {1.5, 4.0}) {  // of the second one the whole square is saturated
    std::mt19937 random(3);
    const auto spots = testing::scatter_spots(camera.shape, 40, 30, 14, sigma_px, 900, random);
    Detector detector(settings_for(camera), camera.shape);
    Detections found(256);
    detector.detect(SpotImage(camera, spots, random).view(), found);
    const auto score = testing::score_spots(found, spots, 1.5);
    EXPECT_EQ(score.pairs, spots.size());
    EXPECT_EQ(score.found, spots.size());
    EXPECT_LT(score.rms_px, 0.2);
    EXPECT_LT(score.normalised_variance, 3);
  }
}

TEST(Detector, splits_images_that_overlap) {
  const testing::Camera camera;
  std::mt19937 random(5);
  std::vector<PaintedSpot> spots;
  for (int k = 0; k < 36; ++k) {  // pairs at all angles, 3.5 px apart
    const double x = 20 + 40 * (k % 6), y = 20 + 40 * (k / 6), angle = 0.17 * k;
    spots.push_back({x + 0.1 * k / 36, y, 1, 150});
    spots.push_back({x + 3.5 * std::cos(angle), y + 3.5 * std::sin(angle), 1, 120});
  }
  Detector detector(settings_for(camera), camera.shape);
  Detections found(256);
  detector.detect(SpotImage(camera, spots, random).view(), found);
  const auto score = testing::score_spots(found, spots, 1);
  EXPECT_EQ(score.pairs, spots.size());
  EXPECT_EQ(score.found, spots.size());
  EXPECT_LT(score.rms_px, 0.1);
}

TEST(Detector, gives_the_same_bits_with_every_instruction_set) {
  std::mt19937 random(11);
  for (const std::uint32_t bytes_per_pixel : {1U, 2U})
    for (const char* method : {"gaussian", "three_point", "centroid"}) {
      const testing::Camera camera{{211, 203, bytes_per_pixel}, 10, 2, 4, 255};
      auto spots = testing::scatter_spots(camera.shape, 900, 0, 0, 1.2, 300, random);
      const SpotImage image(camera, spots, random);
      Detections plain(4096), found(4096);
      Detector(settings_for(camera, method), camera.shape, {}, 0, InstructionSet::portable).detect(image.view(), plain);
      ASSERT_GT(plain.size(), 300U);
      for (const auto set : testing::sets_here()) {
        Detector(settings_for(camera, method), camera.shape, {}, 0, set).detect(image.view(), found);
        EXPECT_EQ(found.x_px, plain.x_px) << name_of(set);
        EXPECT_EQ(found.y_px, plain.y_px) << name_of(set);
        EXPECT_EQ(found.sigma_px, plain.sigma_px) << name_of(set);
        EXPECT_EQ(found.grey, plain.grey) << name_of(set);
        EXPECT_EQ(found.area_px, plain.area_px) << name_of(set);
      }
    }
}

TEST(Detector, counts_what_there_is_no_room_for) {
  const testing::Camera camera{{1024, 1024, 1}, 10, 2, 4, 255};
  std::vector<std::uint8_t> grey(camera.shape.pixels(), 10);
  std::size_t lit = 0;
  for (std::size_t y = 1; y < 1023; y += 3)
    for (std::size_t x = 1; x < 1023; x += 3, ++lit) grey[y * 1024 + x] = 200;
  ASSERT_GT(lit, 100'000U);
  auto settings = settings_for(camera);
  settings.min_area_px = 1, settings.max_detections = 1000;
  Detector detector(settings, camera.shape);
  Detections found(500);
  detector.detect({reinterpret_cast<const std::byte*>(grey.data()), camera.shape}, found);
  EXPECT_EQ(found.size(), 500U);
  EXPECT_EQ(found.size() + found.overflow(), lit);
}

TEST(Detector, survives_images_that_are_empty_full_or_too_small) {
  for (const ImageShape shape : {ImageShape{1, 1, 1}, ImageShape{2, 9, 2}, ImageShape{3, 3, 1}, ImageShape{64, 64, 2}})
    for (const std::byte value : {std::byte{0}, std::byte{255}}) {
      const std::vector<std::byte> bytes(shape.bytes(), value);
      for (const char* method : {"gaussian", "three_point", "centroid"}) {
        DetectorSettings settings;
        settings.method = method;
        Detector detector(settings, shape);
        Detections found(16);
        detector.detect({bytes.data(), shape}, found);
        EXPECT_EQ(found.size(), 0U);
        EXPECT_EQ(detector.counts().frames, 1U);
      }
    }
}

TEST(Detector, refuses_and_counts_images_of_another_shape) {
  Detector detector({}, {64, 48, 1});
  Detections found(16);
  found.push({});
  const std::vector<std::byte> bytes(64 * 64);
  detector.detect({bytes.data(), {48, 64, 1}}, found);
  detector.detect({}, found);
  EXPECT_EQ(found.size(), 0U);
  EXPECT_EQ(detector.counts().refused_frames, 2U);
  const ImageView background{bytes.data(), {32, 32, 1}};
  DetectorSettings settings;
  settings.background_images = {"dark_1.png", "dark_2.png"};
  try {
    Detector(settings, {64, 48, 1}, background, 1);
    FAIL() << "took a background of another shape";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::configuration);
    EXPECT_NE(std::string(error.what()).find("dark_2.png"), std::string::npos);
  }
}

TEST(Detector, costs_no_allocation) {
  if (!AllocationCounter::kCounts) GTEST_SKIP() << "the sanitizer has replaced malloc";
  const testing::Camera camera;
  std::mt19937 random(2);
  const SpotImage image(camera, testing::scatter_spots(camera.shape, 800, 0, 0, 1.3, 300, random), random);
  for (const char* method : {"gaussian", "three_point", "centroid"}) {
    auto settings = settings_for(camera, method);
    settings.running_background = true;
    Detector detector(settings, camera.shape);
    Detections found(500);
    AllocationCounter counter;
    for (int k = 0; k < 40; ++k) detector.detect(image.view(), found);
    counter.disarm();
    EXPECT_EQ(counter.allocations(), 0U);
  }
}

}  // namespace
}  // namespace rptv
