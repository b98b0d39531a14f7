// SPDX-License-Identifier: MIT
// The shared image set of four cameras, from images to particles: falling particles with truth.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <iostream>
#include <map>

#include "core/csv_reader.hpp"
#include "tests/reconstruct/multi_view/cavity_images.hpp"

namespace rptv {
namespace {

namespace fs = std::filesystem;

// The numbers after `key`, from `from` on, which moves behind them; brackets and commas are skipped.
std::vector<double> numbers_after(const std::string& text, const std::string& key, std::size_t count,
                                  std::size_t& from) {
  from = text.find('"' + key + '"', from) + key.size() + 2;
  std::vector<double> numbers;
  while (numbers.size() < count) {
    from = text.find_first_of("-0123456789", from);
    std::size_t length = 0;
    numbers.push_back(std::stod(text.substr(from, 40), &length));
    from += length;
  }
  return numbers;
}

Rig true_rig(const fs::path& file) {
  const std::string text = testing::text_of(file);
  Rig rig;
  std::size_t from = text.find("\"cameras\"");
  for (int c = 0; c < 4; ++c) {
    const auto k = numbers_after(text, "K", 9, from), d = numbers_after(text, "dist", 5, from);
    const auto r = numbers_after(text, "R", 9, from), t = numbers_after(text, "T", 3, from);
    const CameraIntrinsics lens{1920, 1200, k[0], k[4], k[2], k[5], k[1], d[0], d[1], d[4], d[2], d[3], 0, 0};
    const CameraPose pose{{{{r[0], r[1], r[2]}, {r[3], r[4], r[5]}, {r[6], r[7], r[8]}}}, {t[0], t[1], t[2]}};
    rig.cameras.push_back({fmt::format("cam{}", c), CameraModel(lens, pose)});
  }
  return rig;
}

struct Truth {
  std::vector<testing::Position> inside, all;  // of the volume that is scored, and all that are rendered
};

std::map<std::int64_t, Truth> truth_of(const fs::path& file) {
  CsvReader reader(file, {{"frame"}, {"inside_200mm_cube"}, {"X_mm"}, {"Y_mm"}, {"Z_mm"}});
  std::map<std::int64_t, Truth> frames;
  while (reader.next()) {
    const testing::Position at{reader.number(2), reader.number(3), reader.number(4)};
    Truth& frame = frames[reader.integer(0)];
    frame.all.push_back(at);
    if (reader.integer(1) != 0) frame.inside.push_back(at);
  }
  return frames;
}

bool inside(const Particles& found, std::size_t i) {
  return std::max({std::abs(found.x_mm[i]), std::abs(found.y_mm[i]), std::abs(found.z_mm[i])}) <= 100;
}

TEST(MultiViewImages, of_falling_particles_give_them_within_a_twentieth_of_a_millimetre) {
  const auto folder = testing::shared_folder("four-cameras");
  if (!folder) GTEST_SKIP() << "no four-cameras set";
  const auto truth = truth_of(*folder / "density_0300/tracks.csv");
  testing::CameraFrames cameras({1920, 1200, 1}, 4);
  MultiViewSettings settings;
  settings.detector.threshold = 12, settings.detector.electrons_per_grey = 16;
  settings.volume_x_mm = settings.volume_y_mm = settings.volume_z_mm = {-130, 130};
  settings.max_particles = 4096;
  MultiView multi_view(settings, true_rig(*folder / "calibration_truth.json"), cameras.views("cam", 0));
  Particles found(4096);
  std::size_t true_ones = 0, right = 0, ghosts = 0;
  double squares = 0;
  for (const std::int64_t frame : {0, 8, 16, 23}) {
    for (std::size_t c = 0; c < 4; ++c)
      cameras.load(c, *folder / fmt::format("density_0300/cam{}_{:03}.png", c, frame));
    multi_view.reconstruct(cameras.set(), found);
    const Truth& now = truth.at(frame);
    const auto pairs = testing::match(found, now.inside, 0.5, 0.5);
    std::vector<char> known(found.size());
    for (const auto& pair : testing::match(found, now.all, 0.5, 0.5)) known[pair.found] = 1;
    for (std::size_t i = 0; i < found.size(); ++i) ghosts += known[i] == 0 && inside(found, i) ? 1 : 0;
    true_ones += now.inside.size(), right += pairs.size();
    const auto rms = testing::errors_of(found, now.inside, pairs).rms;
    squares += (rms[0] * rms[0] + rms[1] * rms[1] + rms[2] * rms[2]) * static_cast<double>(pairs.size());
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_GE(found.support[i], settings.min_views);
  }
  const double recall = static_cast<double>(right) / static_cast<double>(true_ones);
  const double precision = static_cast<double>(right) / static_cast<double>(right + ghosts);
  const double rms_mm = std::sqrt(squares / static_cast<double>(right));
  std::cout << fmt::format("four-cameras: {} particles, recall {:.4f}, precision {:.4f}, rms {:.4f} mm\n", true_ones,
                           recall, precision, rms_mm);
  EXPECT_GE(recall, 0.99);
  EXPECT_GE(precision, 0.99);
  EXPECT_LE(rms_mm, 0.05);
}

}  // namespace
}  // namespace rptv
