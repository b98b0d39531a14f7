// SPDX-License-Identifier: MIT
// Images of the shared sets: rendered particles with their true places, and a real experiment beside OpenPTV's counts.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <iostream>
#include <set>

#include "core/csv_reader.hpp"
#include "reconstruct/detection/detector.hpp"
#include "tests/reconstruct/detection/spot_score.hpp"
#include "tests/reconstruct/shared_data.hpp"

namespace rptv {
namespace {

namespace fs = std::filesystem;

// Folder of a shared set with that file in it, when there is one.
std::optional<fs::path> shared_folder(const std::string& name, const std::string& file) {
  const char* root = std::getenv("RPTV_SHARED_DATA");
  if (root == nullptr || !fs::exists(fs::path(root) / name / file)) return {};
  return fs::path(root) / name;
}

struct TrueParticle {
  std::int64_t frame;
  bool inside;  // of the volume that is scored; the others are rendered too
  testing::PaintedSpot spot;
};

std::vector<TrueParticle> true_particles(const fs::path& file, int camera) {
  CsvReader reader(file,
                   {{"frame"}, {"inside_200mm_cube"}, {"u" + std::to_string(camera)}, {"v" + std::to_string(camera)}});
  std::vector<TrueParticle> particles;
  while (reader.next())
    particles.push_back(
        {reader.integer(0), reader.integer(1) != 0, {reader.number_or_nan(2), reader.number_or_nan(3), 0, 0}});
  return particles;
}

TEST(DetectorImages, of_falling_particles_are_found_where_they_are) {
  const auto folder = shared_folder("four-cameras/density_0300", "tracks.csv");
  if (!folder) GTEST_SKIP() << "no four-cameras set";
  DetectorSettings settings;
  settings.threshold = 12, settings.electrons_per_grey = 16, settings.find_hidden = true;
  testing::SpotScore total;
  double squares = 0;
  for (int camera = 0; camera < 4; ++camera) {
    const auto truth = true_particles(*folder / "tracks.csv", camera);
    std::optional<Detector> detector;
    Detections found(4096);
    for (int frame = 0; frame < 24; frame += 6) {
      const testing::DecodedImage image(*folder / fmt::format("cam{}_{:03}.png", camera, frame));
      if (!detector) detector.emplace(settings, image.shape);
      detector->detect(image.view(), found);
      std::vector<testing::PaintedSpot> all, inside;
      for (const auto& particle : truth)
        if (particle.frame == frame) {
          all.push_back(particle.spot);
          if (particle.inside) inside.push_back(particle.spot);
        }
      const auto score = testing::score_spots(found, inside, 2);
      total.painted += score.painted, total.pairs += score.pairs;
      squares += score.rms_px * score.rms_px * static_cast<double>(score.pairs);
      total.found += found.size() - testing::score_spots(found, all, 3).pairs;  // ghosts
    }
  }
  const double rms_px = std::sqrt(squares / static_cast<double>(total.pairs));
  std::cout << fmt::format("four-cameras: {} particle images, recall {:.4f}, {} ghosts, rms {:.4f} px\n", total.painted,
                           total.recall(), total.found, rms_px);
  EXPECT_GT(total.recall(), 0.985);
  EXPECT_LT(static_cast<double>(total.found), 0.002 * static_cast<double>(total.pairs));
  EXPECT_LT(rms_px, 0.09);
}

// Local mean within 12 pixels, as OpenPTV's high-pass filter takes away.
std::vector<std::uint8_t> smoothed(const ImageView& image) {
  constexpr int kReach = 12;
  const int width = static_cast<int>(image.shape.width_px), height = static_cast<int>(image.shape.height_px);
  std::vector<double> sums(static_cast<std::size_t>((width + 1) * (height + 1)));
  const auto sum = [&](int x, int y) -> double& { return sums[static_cast<std::size_t>(y * (width + 1) + x)]; };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      sum(x + 1, y + 1) = image.as_u8()[y * width + x] + sum(x, y + 1) + sum(x + 1, y) - sum(x, y);
  std::vector<std::uint8_t> mean;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int x0 = std::max(x - kReach, 0), x1 = std::min(x + kReach + 1, width);
      const int y0 = std::max(y - kReach, 0), y1 = std::min(y + kReach + 1, height);
      const double light = sum(x1, y1) - sum(x0, y1) - sum(x1, y0) + sum(x0, y0);
      mean.push_back(static_cast<std::uint8_t>(light / ((x1 - x0) * (y1 - y0))));
    }
  return mean;
}

// How many different targets of a camera OpenPTV's particles of that frame are made of.
std::size_t openptv_targets(const fs::path& file, int camera) {
  std::ifstream in(file);
  std::size_t count = 0;
  in >> count;
  std::set<int> targets;
  for (std::size_t i = 0; i < count; ++i) {
    double number = 0, x = 0, y = 0, z = 0;
    std::array<int, 4> target{};
    in >> number >> x >> y >> z >> target[0] >> target[1] >> target[2] >> target[3];
    if (target.at(static_cast<std::size_t>(camera)) >= 0) targets.insert(target[static_cast<std::size_t>(camera)]);
  }
  return targets.size();
}

TEST(DetectorImages, of_a_real_cavity_hold_at_least_the_targets_that_openptv_used) {
  const auto folder = shared_folder("cavity", "parameters/targ_rec.par");
  if (!folder) GTEST_SKIP() << "no cavity set";
  std::ifstream parameters(*folder / "parameters/targ_rec.par");
  for (int camera = 0; camera < 4; ++camera) {
    DetectorSettings settings;
    parameters >> settings.threshold;
    settings.threshold_sigmas = 0, settings.min_area_px = 4, settings.radius_px = 1, settings.noise_grey = 2;
    const testing::DecodedImage image(*folder / fmt::format("images/cam{}_10001.tif", camera + 1));
    const auto background = smoothed(image.view());
    Detector detector(settings, image.shape, {reinterpret_cast<const std::byte*>(background.data()), image.shape});
    Detections found(16384);
    detector.detect(image.view(), found);
    const std::size_t openptv = openptv_targets(*folder / "res/rt_is.10001", camera);
    std::cout << fmt::format("cavity, camera {}: {} particle images, {} merged; OpenPTV's particles use {}\n",
                             camera + 1, found.size(), detector.counts().merged, openptv);
    EXPECT_GE(found.size(), openptv);
    EXPECT_LE(found.size(), 10 * openptv);
    EXPECT_EQ(found.overflow(), 0U);
  }
}

}  // namespace
}  // namespace rptv
