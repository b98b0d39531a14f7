// SPDX-License-Identifier: MIT
// Correspondence against an oracle that tries every set of detections with the exact cameras, and on scenes with truth.
#include "reconstruct/multi_view/correspondence.hpp"

#include <gtest/gtest.h>

#include "tests/reconstruct/multi_view/made_views.hpp"

namespace rptv {
namespace {

using testing::ViewScene;

/// The largest exact reprojection error of the point that a set's exact rays are nearest to; huge when that is beyond
/// `half_mm`.
double exact_error_px(const ViewScene& scene, const ViewTuple& tuple, double half_mm) {
  Matrix3 sum{};
  Point3 right{};
  for (std::size_t v = 0; v < scene.rig.cameras.size(); ++v) {
    if (tuple.detection[v] == kUnseen) continue;
    const Detections& seen = scene.detections[v];
    const SightRay ray = scene.rig.cameras[v].model.ray({seen.x_px[tuple.detection[v]], seen.y_px[tuple.detection[v]]});
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        const double across = (i == k ? 1 : 0) - ray.direction[i] * ray.direction[k];
        sum[i][k] += across, right[i] += across * ray.origin_mm[k];
      }
  }
  const Point3 at = inverse(sum) * right;
  double worst = 0;
  for (std::size_t v = 0; v < scene.rig.cameras.size(); ++v) {
    if (tuple.detection[v] == kUnseen) continue;
    const auto pixel = scene.rig.cameras[v].model.project(at);
    const Detections& seen = scene.detections[v];
    worst = std::max(
        worst, std::hypot((*pixel)[0] - seen.x_px[tuple.detection[v]], (*pixel)[1] - seen.y_px[tuple.detection[v]]));
  }
  for (const double coordinate : at)
    if (std::abs(coordinate) > half_mm) return 1e9;
  return worst;
}

std::size_t shared(const ViewTuple& a, const ViewTuple& b) {
  std::size_t same = 0;
  for (std::size_t v = 0; v < kMaxViews; ++v)
    same += a.detection[v] != kUnseen && a.detection[v] == b.detection[v] ? 1 : 0;
  return same;
}

bool within(const ViewTuple& small, const ViewTuple& large) { return shared(small, large) == small.views; }

// What a good set of all views has is left alone.
bool covered(const ViewTuple& any, std::span<const ViewMatch> listed, double tolerance_px) {
  return std::any_of(listed.begin(), listed.end(), [&](const ViewMatch& match) {
    const bool settles = match.tuple.views == 4 && match.square_px2 <= tolerance_px * tolerance_px;
    return within(any, match.tuple) || (settles && shared(any, match.tuple) >= 1);
  });
}

template <class Visit>
void every_tuple(const ViewScene& scene, std::size_t view, ViewTuple& tuple, const Visit& visit) {
  if (view == scene.detections.size()) return visit(tuple);
  for (std::uint32_t i = 0; i <= scene.detections[view].size(); ++i) {
    tuple.put(view, i < scene.detections[view].size() ? i : kUnseen);
    every_tuple(scene, view + 1, tuple, visit);
  }
  tuple.put(view, kUnseen);
}

class CorrespondenceBehind : public ::testing::TestWithParam<bool> {};

TEST_P(CorrespondenceBehind, air_or_water_lists_every_set_that_the_oracle_finds_and_no_other) {
  constexpr double kTolerance_px = 12;  // so large that seven particles near each other make chance sets
  std::size_t sets = 0;
  for (unsigned seed = 1; seed <= (GetParam() ? 2U : 6U); ++seed) {
    const ViewScene scene = testing::make_scene(4, 7, 2, 0.15, GetParam(), seed, 6);
    const auto rays = testing::rays_of(scene);
    CorrespondenceOptions options;
    options.tolerance_px = kTolerance_px;
    Correspondence correspondence(rays, scene.volume, options);
    const auto listed = correspondence.match(scene.detections);
    for (const ViewMatch& match : listed) {
      EXPECT_GE(match.tuple.views, options.min_views);
      EXPECT_LT(exact_error_px(scene, match.tuple, 103), 1.1 * kTolerance_px);
    }
    ViewTuple tuple = ViewTuple::none();
    every_tuple(scene, 0, tuple, [&](const ViewTuple& any) {
      if (any.views < options.min_views || exact_error_px(scene, any, 97) > 0.9 * kTolerance_px) return;
      ++sets;
      EXPECT_TRUE(covered(any, listed, kTolerance_px)) << "seed " << seed;
    });
  }
  EXPECT_GT(sets, GetParam() ? 60U : 200U);
}

INSTANTIATE_TEST_SUITE_P(media, CorrespondenceBehind, ::testing::Bool());

class CorrespondenceOf : public ::testing::TestWithParam<std::size_t> {};

TEST_P(CorrespondenceOf, views_lists_what_each_particle_was_seen_as) {
  const ViewScene scene = testing::make_scene(GetParam(), 60, 0.1, GetParam() > 3 ? 0.1 : 0);
  const auto rays = testing::rays_of(scene);
  CorrespondenceOptions options;
  options.min_views = std::min<std::size_t>(GetParam(), 3);
  options.tolerance_px = 0.6;
  Correspondence correspondence(rays, scene.volume, options);
  const auto listed = correspondence.match(scene.detections);
  std::size_t seen = 0, right = 0;
  for (const ViewTuple& truth : scene.tuples) {
    if (truth.views < options.min_views) continue;
    ++seen;
    right += std::any_of(listed.begin(), listed.end(), [&](const auto& match) { return within(truth, match.tuple); });
  }
  EXPECT_GT(seen, 30U);
  EXPECT_EQ(right, seen);
  EXPECT_EQ(correspondence.counts().unusable_detections, 0U);
}

INSTANTIATE_TEST_SUITE_P(two_to_sixteen, CorrespondenceOf, ::testing::Values(2, 3, 4, 7, 16));

TEST(Correspondence, works_where_cameras_see_each_other) {
  // The epipole is in the image: the lines through it have no order by a finite coordinate.
  ViewScene scene = testing::make_scene(3, 0, 0.1);
  CameraPose behind;
  behind.translation_mm = {3, -2, 1900};  // looks along z, through the volume, at where others are
  scene.rig.cameras.push_back({"behind", CameraModel(scene.rig.cameras[0].model.intrinsics(), behind)});
  CameraPose before = behind;
  before.translation_mm = {-20, 15, 900};
  scene.rig.cameras.push_back({"before", CameraModel(scene.rig.cameras[0].model.intrinsics(), before)});
  testing::look(scene, 60, 0.1, 0, 3, 100);
  const auto rays = testing::rays_of(scene);
  EXPECT_FALSE(PencilOfLines(rays[3], rays[4]).usable && PencilOfLines(rays[4], rays[3]).usable);
  CorrespondenceOptions options;
  options.min_views = 2, options.tolerance_px = 0.6;
  Correspondence correspondence{std::span(rays).last(2), scene.volume, options};
  const auto listed = correspondence.match(std::span(scene.detections).last(2));
  std::size_t seen = 0, right = 0;
  for (const ViewTuple& truth : scene.tuples) {
    if (truth.detection[3] == kUnseen || truth.detection[4] == kUnseen) continue;
    ++seen;
    right += std::any_of(listed.begin(), listed.end(), [&](const ViewMatch& match) {
      return match.tuple.detection[0] == truth.detection[3] && match.tuple.detection[1] == truth.detection[4];
    });
  }
  EXPECT_GT(seen, 30U);
  EXPECT_GE(right, seen * 9 / 10);  // near the line through both cameras their rays do not fix a point
}

TEST(Correspondence, finds_99_in_100_of_1000_particles) {
  const ViewScene scene = testing::make_scene(4, 1000, 0.1);
  const auto rays = testing::rays_of(scene);
  CorrespondenceOptions options;
  options.tolerance_px = 0.6;
  Correspondence correspondence(rays, scene.volume, options);
  const auto listed = correspondence.match(scene.detections);
  std::size_t right = 0;
  for (const ViewTuple& truth : scene.tuples)
    right += std::any_of(listed.begin(), listed.end(), [&](const auto& match) { return match.tuple == truth; });
  EXPECT_GE(right, 990U);
  EXPECT_LT(listed.size(), 1100U);
}

TEST(Correspondence, bounds_its_work_and_counts_what_it_leaves_out) {
  ViewScene scene = testing::make_scene(4, 0, 0.1);
  const auto rays = testing::rays_of(scene);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> column(0, 1919), row(0, 1199);
  for (Detections& seen : scene.detections) {
    seen = Detections(20000);
    for (int i = 0; i < 20000; ++i) seen.push({column(random), row(random), 0.1, 100, 9});
  }
  CorrespondenceOptions options;
  options.max_detections = 15000, options.max_matches = 500;
  Correspondence correspondence(rays, scene.volume, options);
  EXPECT_EQ(correspondence.match(scene.detections).size(), 500U);
  EXPECT_EQ(correspondence.counts().unusable_detections, 4 * 5000U);
  EXPECT_GT(correspondence.counts().refused_matches, 0U);
  EXPECT_GT(correspondence.counts().unsearched, 10000U);
  EXPECT_LT(correspondence.counts().tuples, 2 * Correspondence::kWorkPerMatch * options.max_matches);
}

}  // namespace
}  // namespace rptv
