// SPDX-License-Identifier: MIT
// Matching by several threads gives what one thread gives, to the last bit, also where work and memory are used up.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "reconstruct/multi_view/multi_view.hpp"
#include "tests/core/allocation_counter.hpp"
#include "tests/reconstruct/multi_view/made_views.hpp"

namespace rptv {
namespace {

using testing::ViewScene;

constexpr std::size_t kThreads[]{2, 3, 8};

/// A rig with its rays, made once: four views through air, three through water.
struct MadeRig {
  explicit MadeRig(bool tank)
      : scene(testing::make_scene(tank ? 3 : 4, 0, 0, 0, tank)), rays(testing::rays_of(scene)) {}
  static MadeRig& of(bool tank) {
    static MadeRig air(false), water(true);
    return tank ? water : air;
  }
  ViewScene scene;
  std::vector<ViewRays> rays;
};

void expect_same(const ViewMatch& a, const ViewMatch& b) {
  RC_ASSERT(a.tuple == b.tuple);
  RC_ASSERT(a.at_mm == b.at_mm);
  RC_ASSERT(a.square_px2 == b.square_px2);
  RC_ASSERT(a.s == b.s);
}

void expect_same(const CorrespondenceCounts& a, const CorrespondenceCounts& b) {
  RC_ASSERT(a.unusable_detections == b.unusable_detections);
  RC_ASSERT(a.unsearched == b.unsearched);
  RC_ASSERT(a.refused_hits == b.refused_hits);
  RC_ASSERT(a.refused_matches == b.refused_matches);
  RC_ASSERT(a.rays == b.rays);
  RC_ASSERT(a.pairs == b.pairs);
  RC_ASSERT(a.tuples == b.tuples);
}

RC_GTEST_PROP(Matching, by_any_number_of_threads_lists_the_same_sets_in_the_same_order, ()) {
  MadeRig& made = MadeRig::of(*rc::gen::arbitrary<bool>());
  ViewScene& scene = made.scene;
  scene.particles.clear();
  testing::look(scene, *rc::gen::inRange<std::size_t>(0, 700), 0.2, 0.1, *rc::gen::inRange(1U, 1000U),
                *rc::gen::element(15.0, 60.0, 95.0));
  CorrespondenceOptions options;
  options.min_views = *rc::gen::inRange<std::size_t>(2, made.rays.size() + 1);
  options.tolerance_px = *rc::gen::element(0.3, 1.0, 4.0);
  options.max_detections = *rc::gen::element<std::size_t>(333, 1024);
  options.max_matches = *rc::gen::element<std::size_t>(20, 300, 1000, 65536);
  Correspondence one(made.rays, scene.volume, options);
  const auto listed = one.match(scene.detections);
  for (const std::size_t threads : kThreads) {
    options.threads = threads;
    Correspondence several(made.rays, scene.volume, options);
    for (int frame = 0; frame < 2; ++frame) {
      const auto found = several.match(scene.detections);
      RC_ASSERT(found.size() == listed.size());
      for (std::size_t m = 0; m < found.size(); ++m) expect_same(found[m], listed[m]);
    }
  }
}

RC_GTEST_PROP(Matching, by_any_number_of_threads_counts_the_same, ()) {
  MadeRig& made = MadeRig::of(false);
  ViewScene& scene = made.scene;
  scene.particles.clear();
  testing::look(scene, *rc::gen::inRange<std::size_t>(200, 700), 0.2, 0.1, *rc::gen::inRange(1U, 1000U), 40);
  CorrespondenceOptions options;
  options.tolerance_px = 3;
  options.max_matches = *rc::gen::element<std::size_t>(10, 40, 100, 300, 65536);
  Correspondence one(made.rays, scene.volume, options);
  one.match(scene.detections);
  for (const std::size_t threads : kThreads) {
    options.threads = threads;
    Correspondence several(made.rays, scene.volume, options);
    several.match(scene.detections);
    expect_same(several.counts(), one.counts());
  }
}

MultiView multi_view_of(const ViewScene& scene, std::int64_t threads) {
  MultiViewSettings settings;
  settings.volume_x_mm = settings.volume_y_mm = settings.volume_z_mm = {-100, 100};
  settings.threads = threads;
  std::vector<MultiViewCamera> cameras;
  for (const RigCamera& camera : scene.rig.cameras) cameras.push_back({camera.name, {1920, 1200, 1}, {}});
  return {settings, scene.rig, cameras};
}

TEST(MultiViewBySeveralThreads, finds_the_particles_that_one_thread_finds_and_allocates_nothing) {
  const ViewScene scene = testing::make_scene(4, 1000, 0.1, 0.05);
  Particles found(2000), by_one(2000);
  multi_view_of(scene, 1).reconstruct(scene.detections, by_one);
  EXPECT_GT(by_one.size(), 900U);
  for (const std::int64_t threads : {2, 3, 8}) {
    MultiView multi_view = multi_view_of(scene, threads);
    multi_view.reconstruct(scene.detections, found);
    AllocationCounter counter;
    multi_view.reconstruct(scene.detections, found);
    EXPECT_EQ(counter.disarm(), 0U);  // always, where a sanitizer's allocator is not counted
    EXPECT_EQ(found.x_mm, by_one.x_mm);
    EXPECT_EQ(found.y_mm, by_one.y_mm);
    EXPECT_EQ(found.z_mm, by_one.z_mm);
    EXPECT_EQ(found.residual_mm, by_one.residual_mm);
    EXPECT_EQ(found.support, by_one.support);
    EXPECT_EQ(found.ghost, by_one.ghost);
    EXPECT_EQ(found.covariance_mm2, by_one.covariance_mm2);
  }
}

}  // namespace
}  // namespace rptv
