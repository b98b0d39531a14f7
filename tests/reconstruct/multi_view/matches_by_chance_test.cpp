// SPDX-License-Identifier: MIT
// The bound of chance matches against what Correspondence finds among detections without any particle.
#include "reconstruct/multi_view/matches_by_chance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "reconstruct/multi_view/correspondence.hpp"
#include "reconstruct/multi_view/multi_view.hpp"
#include "tests/reconstruct/multi_view/made_views.hpp"

namespace rptv {
namespace {

using testing::ViewScene;

/// Each view sees particles of its own, at random in the volume.
ViewScene scene_of_chance(std::size_t views, std::size_t detections, bool tank) {
  ViewScene scene{testing::make_rig(views, tank), {{-100, -100, -100}, {100, 100, 100}}, {}, {}, {}};
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-100, 100);
  for (const RigCamera& camera : scene.rig.cameras) {
    Detections& seen = scene.detections.emplace_back(detections);
    while (seen.size() < detections) {
      const auto at = camera.model.project({place(random), place(random), place(random)});
      if (at && camera.model.in_image(*at)) seen.push({(*at)[0], (*at)[1], 0.1, 1000, 9});
    }
  }
  return scene;
}

struct Case {
  std::size_t views, min_views, detections;
  double tolerance_px;
  bool tank;
};

class ChanceOf : public ::testing::TestWithParam<Case> {};

TEST_P(ChanceOf, matches_is_bounded_within_a_small_factor) {
  const Case& c = GetParam();
  const ViewScene scene = scene_of_chance(c.views, c.detections, c.tank);
  const auto rays = testing::rays_of(scene);
  Correspondence correspondence(rays, scene.volume, {c.min_views, c.tolerance_px, c.detections, 2'000'000});
  const auto found = static_cast<double>(correspondence.match(scene.detections).size());
  const double bound = matches_by_chance(scene.rig, scene.volume, c.detections, c.min_views, c.tolerance_px);
  EXPECT_GT(found, 100);
  EXPECT_LT(found, 1.1 * bound);
  EXPECT_GT(found, bound * std::pow(0.5, static_cast<double>(c.min_views - 2)) * 0.8);
}

INSTANTIATE_TEST_SUITE_P(Rigs, ChanceOf,
                         ::testing::Values(Case{3, 3, 3000, 1, false}, Case{4, 3, 3000, 1, false},
                                           Case{4, 3, 3000, 2, false}, Case{4, 3, 3000, 1, true},
                                           Case{4, 2, 500, 1, false}, Case{4, 4, 5000, 2, false},
                                           Case{6, 4, 3000, 2, false}));

TEST(MaxMatches, of_0_are_enough_for_what_chance_makes_of_the_settings) {
  ViewScene scene = testing::make_scene(4, 2500, 0.1);
  std::vector<MultiViewCamera> cameras;
  for (const RigCamera& camera : scene.rig.cameras) cameras.push_back({camera.name, {1920, 1200, 1}, {}});
  MultiViewSettings settings;
  settings.volume_x_mm = settings.volume_y_mm = settings.volume_z_mm = {-100, 100};
  settings.tolerance_px = 2, settings.detector.max_detections = 2500;
  Particles found(10000);
  const auto refused = [&](std::int64_t max_matches) {
    settings.max_matches = max_matches;
    MultiView stage(settings, scene.rig, cameras);
    stage.reconstruct(scene.detections, found);
    return stage.losses().of(LossCause::match_overflow) + stage.losses().of(LossCause::search_cut);
  };
  EXPECT_GT(refused(5000), 0U) << "room for each particle twice";
  EXPECT_EQ(refused(0), 0U);
  EXPECT_GT(found.size(), 2300U);
  EXPECT_LT(with_room(settings, scene.rig).max_matches, 100'000);
  settings.tolerance_px = 50;
  EXPECT_EQ(with_room(settings, scene.rig).max_matches, 1 << 20) << "more has to be asked for";
}

}  // namespace
}  // namespace rptv
