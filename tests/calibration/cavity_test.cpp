// SPDX-License-Identifier: MIT
// OpenPTV's calibration of a real experiment (R. Elfassi, D. Ratner, M. Kreizer, A. Liberzon, Tel Aviv:
// OpenPTV/test_cavity) against the images of its target: do four rays through glass and water cross where the target's
// dots are?
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <optional>

#include "calibration/openptv.hpp"
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

struct Crossing {
  std::size_t dots = 0;
  double median_mm = 0;
};

/// Of all dots that every camera sees.
Crossing crossing_of(const Rig& rig, const fs::path& set) {
  std::vector<Grey> images;
  for (const auto& camera : rig.cameras) images.emplace_back(set / "cal" / (camera.name + ".tif"));
  std::ifstream target(set / "cal" / "target_on_a_side.txt");
  std::vector<double> residuals;
  for (double id, x, y, z; target >> id >> x >> y >> z;) {
    std::vector<SightRay> rays;
    for (std::size_t k = 0; k < rig.cameras.size(); ++k) {
      const auto expected = rig.cameras[k].model.project({x, y, z});
      const auto dot = expected ? dot_near(images[k], *expected) : std::nullopt;
      if (dot) rays.push_back(rig.cameras[k].model.ray(*dot));
    }
    if (rays.size() == rig.cameras.size()) residuals.push_back(crossing_mm(rays));
  }
  if (residuals.empty()) return {};
  const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
  std::nth_element(residuals.begin(), middle, residuals.end());
  return {residuals.size(), *middle};
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

TEST_F(Cavity, they_miss_each_other_with_glass_and_liquid_swapped) {
  Rig swapped;
  for (const auto& camera : import_openptv(set_).rig.cameras) {
    RefractiveStack stack = camera.model.stack();
    std::swap(stack.interfaces.at(0).behind, stack.interfaces.at(1).behind);
    swapped.cameras.push_back({camera.name, CameraModel(camera.model.intrinsics(), camera.model.pose(), stack)});
  }
  EXPECT_GT(crossing_of(swapped, set_).median_mm, 1);
}

}  // namespace
}  // namespace rptv
