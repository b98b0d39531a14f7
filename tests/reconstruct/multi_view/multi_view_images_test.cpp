// SPDX-License-Identifier: MIT
// The shared image sets of four cameras, from images to particles: falling particles with truth, and a real cavity
// behind glass and water beside OpenPTV.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iostream>
#include <map>

#include "calibration/cameras/openptv.hpp"
#include "calibration/space_algebra.hpp"
#include "core/csv_reader.hpp"
#include "reconstruct/multi_view/multi_view.hpp"
#include "tests/reconstruct/multi_view/camera_frames.hpp"
#include "tests/reconstruct/shared_data.hpp"

namespace rptv {
namespace {

namespace fs = std::filesystem;

std::optional<fs::path> shared_folder(const std::string& name) {
  const char* root = std::getenv("RPTV_SHARED_DATA");
  if (root == nullptr || !fs::exists(fs::path(root) / name)) return {};
  return fs::path(root) / name;
}

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
  const auto folder = shared_folder("four-cameras");
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

// The darkest that a pixel was in the five frames: what is left when particles move.
testing::DecodedImage darkest(const fs::path& folder, int camera) {
  testing::DecodedImage dark(folder / fmt::format("images/cam{}_10000.tif", camera));
  for (int frame = 1; frame < 5; ++frame) {
    const testing::DecodedImage next(folder / fmt::format("images/cam{}_1000{}.tif", camera, frame));
    std::transform(dark.bytes.begin(), dark.bytes.end(), next.bytes.begin(), dark.bytes.begin(),
                   [](std::byte a, std::byte b) { return std::min(a, b); });
  }
  return dark;
}

std::vector<Point3> openptv_points(const fs::path& file) {
  std::ifstream in(file);
  std::size_t count = 0;
  in >> count;
  std::vector<Point3> points(count);
  std::array<int, 4> targets{};
  int number = 0;
  for (Point3& at : points)
    in >> number >> at[0] >> at[1] >> at[2] >> targets[0] >> targets[1] >> targets[2] >> targets[3];
  return points;
}

// From where a point would be seen to the nearest particle image: rms of the best three views, median of every eighth
// point.
double median_miss_px(const Rig& rig, std::span<const Detections> seen, const std::vector<Point3>& points) {
  std::vector<double> misses;
  for (std::size_t p = 0; p < points.size(); p += 8) {
    const Point3& at = points[p];
    std::array<double, 4> nearest{};
    for (std::size_t c = 0; c < 4; ++c) {
      nearest[c] = 1e6;
      const auto pixel = rig.cameras[c].model.project(at);
      for (std::size_t i = 0; pixel && i < seen[c].size(); ++i)
        nearest[c] = std::min(nearest[c], std::hypot(seen[c].x_px[i] - (*pixel)[0], seen[c].y_px[i] - (*pixel)[1]));
    }
    std::sort(nearest.begin(), nearest.end());
    misses.push_back(std::sqrt((nearest[0] * nearest[0] + nearest[1] * nearest[1] + nearest[2] * nearest[2]) / 3));
  }
  std::nth_element(misses.begin(), misses.begin() + static_cast<std::ptrdiff_t>(misses.size() / 2), misses.end());
  return misses[misses.size() / 2];
}

// OpenPTV's counts are those that its regression test keeps; they and its points include particles of two views.
TEST(MultiViewImages, of_a_real_cavity_give_more_particles_than_openptv_at_a_lower_residual) {
  const auto folder = shared_folder("cavity");
  if (!folder) GTEST_SKIP() << "no cavity set";
  testing::CameraFrames cameras({1280, 1024, 1}, 4);
  auto views = cameras.views("cam", 1);
  std::vector<testing::DecodedImage> backgrounds;
  for (int c = 0; c < 4; ++c) backgrounds.push_back(darkest(*folder, c + 1));
  for (std::size_t c = 0; c < 4; ++c) views[c].background = backgrounds[c].view();
  MultiViewSettings settings;
  settings.detector.threshold = 9, settings.detector.noise_grey = 2, settings.detector.threshold_sigmas = 0;
  settings.detector.radius_px = 1, settings.detector.min_area_px = 4;
  settings.volume_x_mm = {-40, 40}, settings.volume_y_mm = {-25, 85}, settings.volume_z_mm = {-45, 45};
  settings.tolerance_px = 1.5, settings.calibration_px = 0.5;
  const Rig rig = import_openptv(*folder).rig;
  MultiView multi_view(settings, rig, views);
  Particles found(16384);
  constexpr std::array<double, 3> kOpenptv{672, 699, 711};
  for (std::size_t frame = 1; frame < 4; ++frame) {
    for (std::size_t c = 0; c < 4; ++c) cameras.load(c, *folder / fmt::format("images/cam{}_1000{}.tif", c + 1, frame));
    multi_view.reconstruct(cameras.set(), found);
    std::vector<Point3> points;
    double true_ones = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_GE(found.support[i], 3);
      points.push_back({found.x_mm[i], found.y_mm[i], found.z_mm[i]});
      true_ones += 1 - found.ghost[i];
    }
    const double miss_px = median_miss_px(rig, multi_view.detections(), points);
    const auto theirs = openptv_points(*folder / fmt::format("res/rt_is.1000{}", frame));
    const double their_miss_px = median_miss_px(rig, multi_view.detections(), theirs);
    std::cout << fmt::format(
        "cavity, frame {}: {} particles of 3 and 4 views, {:.0f} by their ghost probabilities, median "
        "miss {:.2f} px; OpenPTV {} and, of {} published, {:.2f} px\n",
        frame, found.size(), true_ones, miss_px, kOpenptv.at(frame - 1), theirs.size(), their_miss_px);
    EXPECT_GE(true_ones, kOpenptv.at(frame - 1));
    EXPECT_LT(miss_px, their_miss_px);
  }
}

}  // namespace
}  // namespace rptv
