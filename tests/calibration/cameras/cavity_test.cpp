// SPDX-License-Identifier: MIT
// OpenPTV's calibration of a real experiment (R. Elfassi, D. Ratner, M. Kreizer, A. Liberzon, Tel Aviv:
// OpenPTV/test_cavity) against the images of its target: do four rays through glass and water cross where the target's
// dots are?
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>
#include <optional>

#include "calibration/cameras/known_points.hpp"
#include "calibration/cameras/openptv.hpp"
#include "calibration/space_algebra.hpp"
#include "replay/image_file.hpp"

namespace rptv {
namespace {

namespace fs = std::filesystem;

struct Grey {
  explicit Grey(const fs::path& file) {
    const auto reader = open_image(file);
    shape = reader->header(0).shape;
    bytes.resize(shape.bytes());
    reader->decode(0, bytes);
  }
  int at(int column, int row) const {
    return std::to_integer<int>(
        bytes[static_cast<std::size_t>(row) * shape.width_px + static_cast<std::size_t>(column)]);
  }
  ImageShape shape;
  std::vector<std::byte> bytes;
};

/// Centre of the brightest spot within 14 px of `near`; none where there is no bright one.
std::optional<Pixel> dot_near(const Grey& image, const Pixel& near) {
  constexpr int kReach = 14, kBox = 3, kSpot = 6, kMargin = kReach + kSpot + 1;
  const int column = static_cast<int>(std::lround(near[0])), row = static_cast<int>(std::lround(near[1]));
  if (column < kMargin || row < kMargin || column >= static_cast<int>(image.shape.width_px) - kMargin ||
      row >= static_cast<int>(image.shape.height_px) - kMargin)
    return {};
  int brightest = -1, x0 = 0, y0 = 0;
  for (int y = row - kReach; y <= row + kReach; ++y)
    for (int x = column - kReach; x <= column + kReach; ++x) {
      int sum = 0;
      for (int j = -kBox; j <= kBox; ++j)
        for (int i = -kBox; i <= kBox; ++i) sum += image.at(x + i, y + j);
      if (sum > brightest) brightest = sum, x0 = x, y0 = y;
    }
  int lowest = 255;
  for (int j = -kSpot; j <= kSpot; ++j)
    for (int i = -kSpot; i <= kSpot; ++i) lowest = std::min(lowest, image.at(x0 + i, y0 + j));
  double sum = 0, x = 0, y = 0;
  for (int j = -kSpot; j <= kSpot; ++j)
    for (int i = -kSpot; i <= kSpot; ++i) {
      const double grey = std::max(0, image.at(x0 + i, y0 + j) - lowest - 25);
      sum += grey, x += grey * (x0 + i), y += grey * (y0 + j);
    }
  if (sum < 500) return {};
  return Pixel{x / sum, y / sum};
}

/// Root mean square distance of the rays from the point nearest to all of them, mm.
double crossing_mm(const std::vector<SightRay>& rays) {
  Matrix3 sum{};
  Point3 right{};
  for (const auto& ray : rays)
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        const double across = (i == j ? 1.0 : 0.0) - ray.direction[i] * ray.direction[j];
        sum[i][j] += across, right[i] += across * ray.origin_mm[j];
      }
  const Point3 nearest = inverse(sum) * right;
  double squares = 0;
  for (const auto& ray : rays) {
    const double off = norm(cross(nearest - ray.origin_mm, ray.direction));
    squares += off * off;
  }
  return std::sqrt(squares / static_cast<double>(rays.size()));
}

std::vector<Grey> images_of(const Rig& rig, const fs::path& set) {
  std::vector<Grey> images;
  for (const auto& camera : rig.cameras) images.emplace_back(set / "cal" / (camera.name + ".tif"));
  return images;
}

/// All dots that cameras see, as they say themselves.
std::vector<KnownPoint> dots_of(const Rig& rig, const fs::path& set) {
  std::vector<KnownPoint> dots;
  std::ifstream target(set / "cal" / "target_on_a_side.txt");
  const auto images = images_of(rig, set);
  for (double id, x, y, z; target >> id >> x >> y >> z;)
    for (std::size_t k = 0; k < rig.cameras.size(); ++k) {
      const auto expected = rig.cameras[k].model.project({x, y, z});
      const auto dot = expected ? dot_near(images[k], *expected) : std::nullopt;
      if (dot) dots.push_back({k, {x, y, z}, *dot});
    }
  return dots;
}

struct Crossing {
  std::size_t dots = 0;
  double median_mm = 0;
};

/// Of all dots that every camera sees.
Crossing crossing_of(const Rig& rig, const fs::path& set) {
  std::map<Point3, std::vector<SightRay>> rays;
  for (const KnownPoint& dot : dots_of(rig, set))
    rays[dot.position_mm].push_back(rig.cameras[dot.camera].model.ray(dot.pixel));
  std::vector<double> residuals;
  for (const auto& [dot, seen] : rays)
    if (seen.size() == rig.cameras.size()) residuals.push_back(crossing_mm(seen));
  if (residuals.empty()) return {};
  const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
  std::nth_element(residuals.begin(), middle, residuals.end());
  return {residuals.size(), *middle};
}

Rig with_media_swapped(const Rig& rig) {
  Rig swapped;
  for (const auto& camera : rig.cameras) {
    RefractiveStack stack = camera.model.stack();
    std::swap(stack.interfaces.at(0).behind, stack.interfaces.at(1).behind);
    swapped.cameras.push_back({camera.name, CameraModel(camera.model.intrinsics(), camera.model.pose(), stack)});
  }
  return swapped;
}

class Cavity : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* root = std::getenv("RPTV_SHARED_DATA");
    if (root == nullptr || !fs::exists(fs::path(root) / "cavity" / "cal")) GTEST_SKIP() << "skipped: no shared data";
    set_ = fs::path(root) / "cavity";
  }
  fs::path set_;
};

TEST_F(Cavity, the_rays_of_a_dot_cross_with_the_media_in_liboptvs_order) {
  const Crossing ours = crossing_of(import_openptv(set_).rig, set_);
  fmt::print("  {} dots in four cameras, median crossing residual {:.4f} mm\n", ours.dots, ours.median_mm);
  EXPECT_GE(ours.dots, 40U);
  EXPECT_LT(ours.median_mm, 0.065);
}

TEST_F(Cavity, cameras_fitted_to_the_dots_cross_closer) {
  const Rig published = import_openptv(set_).rig;
  const auto fit = fit_known_points(published, dots_of(published, set_), CameraFreedom::distortion, "dots");
  for (std::size_t k = 0; k < fit.cameras.size(); ++k) {
    const auto& camera = fit.cameras[k];
    fmt::print("  {}: {} dots, {} left out, {:.3f} px rms before, {:.3f} after\n", published.cameras[k].name,
               camera.points, camera.left_out, camera.before_rms_px, camera.rms_px);
    EXPECT_LT(camera.rms_px, camera.before_rms_px);
  }
  const Crossing ours = crossing_of(fit.rig, set_);
  fmt::print("  {} dots in four cameras, median crossing residual {:.4f} mm\n", ours.dots, ours.median_mm);
  EXPECT_LT(ours.median_mm, 0.04);
}

TEST_F(Cavity, with_glass_and_liquid_swapped_they_miss_each_other_until_the_cameras_are_fitted_again) {
  const Rig published = import_openptv(set_).rig;
  const Rig swapped = with_media_swapped(published);  // as they are: glass above water
  EXPECT_GT(crossing_of(swapped, set_).median_mm, 1);
  const auto dots = dots_of(published, set_);
  const Rig placed = fit_known_points(swapped, dots, CameraFreedom::pose, "dots").rig;
  const Crossing pose = crossing_of(placed, set_);
  const Crossing lens = crossing_of(fit_known_points(placed, dots, CameraFreedom::distortion, "dots").rig, set_);
  fmt::print("  poses fitted: {} dots, {:.4f} mm; lenses too: {} dots, {:.4f} mm\n", pose.dots, pose.median_mm,
             lens.dots, lens.median_mm);
  EXPECT_LT(pose.median_mm, 0.04);
  EXPECT_LT(lens.median_mm, 0.025);
}

}  // namespace
}  // namespace rptv
