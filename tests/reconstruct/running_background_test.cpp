// SPDX-License-Identifier: MIT
// The background that follows the experiment: statistics per pixel, the learner's thread, and the whole stage on it.
#include "reconstruct/running_background.hpp"

#include <gtest/gtest.h>

#include <random>
#include <thread>

#include "core/clock.hpp"
#include "reconstruct/light_field/light_field.hpp"
#include "tests/core/allocation_counter.hpp"
#include "tests/reconstruct/light_field/small_scene.hpp"

namespace rptv {
namespace {

constexpr std::size_t kPixels = 4000;

// Images of noise round 100 + i mod 50, rms 2 + i mod 3; every pixel is lit one time in twenty.
class Noise {
 public:
  std::vector<std::uint16_t> next() {
    std::vector<std::uint16_t> grey(kPixels);
    for (std::size_t i = 0; i < kPixels; ++i) {
      const bool lit = std::uniform_int_distribution<int>(0, 19)(random_) == 0;
      const double value = mean(i) + offset + sigma(i) * normal_(random_) + (lit ? 200 : 0);
      grey[i] = static_cast<std::uint16_t>(std::lround(value));
    }
    return grey;
  }
  static double mean(std::size_t i) { return 100.0 + static_cast<double>(i % 50); }
  static double sigma(std::size_t i) { return 2.0 + static_cast<double>(i % 3); }
  double offset = 0;

 private:
  std::mt19937 random_{3};
  std::normal_distribution<double> normal_;
};

struct Misses {
  double mean = 0, sigma_ratio = 0;  ///< mean over the pixels of (mean - true)/σ and of σ/true
};

Misses misses_of(const PixelStatistics& statistics, double offset) {
  Misses m;
  for (std::size_t i = 0; i < kPixels; ++i) {
    m.mean += std::abs(static_cast<double>(statistics.mean()[i]) - Noise::mean(i) - offset) / Noise::sigma(i) / kPixels;
    m.sigma_ratio += static_cast<double>(statistics.sigma()[i]) / Noise::sigma(i) / kPixels;
  }
  return m;
}

void feed(PixelStatistics& statistics, Noise& noise, int images) {
  for (int k = 0; k < images; ++k) {
    const auto grey = noise.next();
    statistics.update(0, std::span<const std::uint16_t>(grey).first(kPixels / 2));
    statistics.update(kPixels / 2, std::span<const std::uint16_t>(grey).last(kPixels / 2));
    statistics.end_round();
  }
}

TEST(PixelStatistics, finds_mean_and_noise_although_particles_pass) {
  PixelStatistics statistics(kPixels, 0, 1, 100);
  Noise noise;
  feed(statistics, noise, 400);
  const Misses m = misses_of(statistics, 0);
  EXPECT_LT(m.mean, 0.3);
  EXPECT_NEAR(m.sigma_ratio, 1.1, 0.2);
}

TEST(PixelStatistics, follows_a_change_and_forgets_a_wrong_start) {
  Noise noise;
  std::vector<float> wrong(kPixels, 500.0F);
  PixelStatistics statistics(wrong, 1, 50);
  feed(statistics, noise, 600);
  EXPECT_LT(misses_of(statistics, 0).mean, 0.4);
  noise.offset = 12;
  feed(statistics, noise, 400);
  EXPECT_LT(misses_of(statistics, 12).mean, 0.4);
}

TEST(DarkLimit, follows_mean_and_noise) {
  DarkLimit limit({4, 1, 2}, 0, 0);
  const std::vector<float> mean{10, 10, 70000, 3.5F}, sigma{1, 8, 1, 0.5F};
  limit.follow(mean, sigma, {}, 20, 5);
  EXPECT_EQ(std::vector<std::uint16_t>(limit.limits().begin(), limit.limits().end()),
            (std::vector<std::uint16_t>{30, 50, 65535, 23}));
}

// A stage that starts with a background that is wrong everywhere.
LightFieldSettings learning_settings() {
  auto settings = testing::small_settings();
  settings.running_background = true, settings.threshold_sigmas = 6, settings.background_frames = 30;
  settings.noise_grey = 2;
  return settings;
}

std::vector<std::uint16_t> with_background(const testing::PaintedImage& image, std::mt19937& random) {
  std::normal_distribution<double> noise(0, 2);
  std::vector<std::uint16_t> grey;
  for (std::size_t i = 0; i < 512 * 384; ++i) {
    const double under = 300 + static_cast<double>(i % 200);
    const auto painted = const_cast<testing::PaintedImage&>(image).pixels()[i];
    grey.push_back(static_cast<std::uint16_t>(std::lround(under + painted + noise(random))));
  }
  return grey;
}

TEST(RunningBackground, lets_the_stage_find_its_particles_without_being_told_the_background) {
  LightField light_field(learning_settings(), testing::small_camera(), {});
  std::mt19937 random(5);
  Particles found(512);
  const std::int64_t deadline_ns = host_now_ns() + 60'000'000'000;
  std::size_t hits = 0, ghosts = 1;
  for (unsigned frame = 0; (hits < 9 || ghosts > 0) && host_now_ns() < deadline_ns; ++frame) {
    const auto truth = testing::scatter(10, 1.5, 1.0, -18, 9, 0.9, 100 + frame);
    const auto grey = with_background(testing::paint(truth), random);
    light_field.reconstruct({reinterpret_cast<const std::byte*>(grey.data()), {512, 384, 2}}, found);
    hits = 0;
    for (const auto& p : truth) hits += testing::nearest(found, p) >= 0;
    ghosts = found.size() - hits;
  }
  EXPECT_GE(hits, 9U);
  EXPECT_EQ(ghosts, 0U);
}

TEST(RunningBackground, costs_the_stage_no_allocation) {
  if (!AllocationCounter::kCounts) GTEST_SKIP() << "the sanitizer has replaced malloc";
  LightField light_field(learning_settings(), testing::small_camera(), {});
  const auto image = testing::paint(testing::scene(4));
  Particles found(512);
  light_field.reconstruct(image.view(), found);
  AllocationCounter counter;
  for (int k = 0; k < 40; ++k) light_field.reconstruct(image.view(), found);
  counter.disarm();
  EXPECT_EQ(counter.allocations(), 0U);
}

TEST(RunningBackground, hands_whole_backgrounds_over_while_both_sides_run) {
  constexpr ImageShape kShape{64, 48, 1};
  RunningBackground background(kShape, {std::vector<float>(kShape.pixels()), DarkLimit(kShape, 0, 0)}, 1, false,
                               {10, 0, 20});
  std::vector<std::uint8_t> grey(kShape.pixels());
  const std::int64_t deadline_ns = host_now_ns() + 60'000'000'000;
  for (std::uint64_t k = 0; background.published() < 200 && host_now_ns() < deadline_ns; ++k) {
    std::fill(grey.begin(), grey.end(), static_cast<std::uint8_t>(50 + k / 1000 % 100));
    background.offer({reinterpret_cast<const std::byte*>(grey.data()), kShape});
    if (!background.refresh()) std::this_thread::yield();
    // Limits and means of one copy belong together.
    const auto& dark = background.dark();
    for (std::size_t i = 0; i < kShape.pixels(); i += 97)
      ASSERT_EQ(dark.limit.limits()[i],
                static_cast<std::uint16_t>(dark.mean[i] > 0 ? std::floor(dark.mean[i] + 10) : 0));
  }
  EXPECT_GE(background.published(), 200U);
}

}  // namespace
}  // namespace rptv
