// SPDX-License-Identifier: MIT
// Beans: where they are, how they lie, and what happens where they touch each other or the border.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reconstruct/detection/detector.hpp"
#include "tests/core/allocation_counter.hpp"
#include "tests/reconstruct/random_image.hpp"

namespace rptv {
namespace {

using testing::RandomImage;

// Ellipses of even light, as beans; half-axes a and b, turned by `angle`.
struct Bean {
  double x, y, a, b, angle;
};

RandomImage paint_beans(const std::vector<Bean>& beans, ImageShape shape, std::mt19937& random) {
  RandomImage image{shape, std::vector<std::byte>(shape.bytes())};
  std::normal_distribution<double> noise(0, 2);
  for (int y = 0; y < static_cast<int>(shape.height_px); ++y)
    for (int x = 0; x < static_cast<int>(shape.width_px); ++x) {
      double grey = 10;
      for (const auto& bean : beans) {
        const double c = std::cos(bean.angle), s = std::sin(bean.angle);
        const double u = (c * (x - bean.x) + s * (y - bean.y)) / bean.a;
        const double v = (c * (y - bean.y) - s * (x - bean.x)) / bean.b;
        grey = std::max(grey, 10 + 150 * std::clamp(4 * (1.1 - std::hypot(u, v)), 0.0, 1.0));
      }
      image.set(x, y, static_cast<std::uint16_t>(std::lround(std::clamp(grey + noise(random), 0.0, 255.0))));
    }
  return image;
}

DetectorSettings bean_settings() {
  DetectorSettings settings;
  settings.method = "blob", settings.background = 10, settings.noise_grey = 2, settings.min_area_px = 20;
  settings.electrons_per_grey = 1e6;
  settings.split_sigmas = 8;
  return settings;
}

TEST(Blobs, tell_where_beans_are_and_how_they_lie) {
  std::mt19937 random(1);
  std::vector<Bean> beans;
  for (int k = 0; k < 25; ++k) beans.push_back({40.3 + 50 * (k % 5), 40.7 + 50 * (k / 5), 14, 7, -1.5 + 0.12 * k});
  const ImageShape shape{290, 290, 1};
  Detector detector(bean_settings(), shape);
  Detections found(64);
  detector.detect(paint_beans(beans, shape, random).view(), found);
  ASSERT_EQ(found.size(), beans.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto& bean = *std::min_element(beans.begin(), beans.end(), [&](const Bean& p, const Bean& q) {
      return std::hypot(p.x - found.x_px[i], p.y - found.y_px[i]) <
             std::hypot(q.x - found.x_px[i], q.y - found.y_px[i]);
    });
    EXPECT_NEAR(found.x_px[i], bean.x, 0.1);
    EXPECT_NEAR(found.y_px[i], bean.y, 0.1);
    EXPECT_LT(found.sigma_px[i], 0.1);
    EXPECT_NEAR(std::remainder(found.angle_rad[i] - bean.angle, std::numbers::pi), 0, 0.03);
    EXPECT_NEAR(found.long_px[i] / found.short_px[i], 2, 0.1);
  }
}

TEST(Blobs, that_touch_are_taken_apart_and_those_at_the_border_are_counted) {
  std::mt19937 random(2);
  const std::vector<Bean> beans{{60, 60, 12, 8, 0}, {83, 60, 12, 8, 0}, {140, 60, 9, 9, 0}, {0, 120, 9, 9, 0}};
  const ImageShape shape{200, 200, 1};
  Detector detector(bean_settings(), shape);
  Detections found(64);
  detector.detect(paint_beans(beans, shape, random).view(), found);
  EXPECT_EQ(found.size(), 3U);
  EXPECT_EQ(detector.counts().at_border, 1U);
  auto together = bean_settings();
  together.split_sigmas = 1000;
  Detector joined(together, shape);
  joined.detect(paint_beans(beans, shape, random).view(), found);
  EXPECT_EQ(found.size(), 2U);
}

TEST(Blobs, larger_than_allowed_are_counted_in_bounded_time) {
  const ImageShape shape{1000, 1000, 1};
  const RandomImage image{shape, std::vector<std::byte>(shape.bytes(), std::byte{255})};
  Detector detector(bean_settings(), shape);
  Detections found(64);
  detector.detect(image.view(), found);
  EXPECT_EQ(found.size(), 0U);
  EXPECT_EQ(detector.counts().too_large, 1U);
}

TEST(Blobs, cost_no_allocation) {
  if (!AllocationCounter::kCounts) GTEST_SKIP() << "the sanitizer has replaced malloc";
  std::mt19937 random(4);
  const ImageShape shape{200, 200, 2};
  RandomImage image = paint_beans({{60, 60, 12, 8, 0}, {83, 60, 12, 8, 0}}, shape, random);
  for (auto& byte : image.bytes) byte |= static_cast<std::byte>(random() % 64);
  Detector detector(bean_settings(), shape);
  Detections found(8);
  AllocationCounter counter;
  for (int k = 0; k < 4; ++k) detector.detect(image.view(), found);
  counter.disarm();
  EXPECT_EQ(counter.allocations(), 0U);
}

}  // namespace
}  // namespace rptv
