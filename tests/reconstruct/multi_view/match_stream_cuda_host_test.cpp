// SPDX-License-Identifier: MIT
// Matching on the device, whole frame sets: against the CPU's matches, against the truth, and when there is too much.
#include "reconstruct/multi_view/match_stream_cuda.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "core/error.hpp"
#include "tests/cuda_host/control.hpp"
#include "tests/reconstruct/multi_view/made_views.hpp"

namespace rptv {
namespace {

using testing::ViewScene;

CorrespondenceOptions options_of(double tolerance_px) {
  CorrespondenceOptions options;
  options.tolerance_px = tolerance_px, options.max_detections = 1500, options.max_matches = 3000;
  return options;
}

bool within(const ViewTuple& small, const ViewTuple& large) {
  for (std::size_t v = 0; v < kMaxViews; ++v)
    if (small.detection[v] != kUnseen && small.detection[v] != large.detection[v]) return false;
  return true;
}

bool share(const ViewTuple& a, const ViewTuple& b) {
  for (std::size_t v = 0; v < kMaxViews; ++v)
    if (a.detection[v] != kUnseen && a.detection[v] == b.detection[v]) return true;
  return false;
}

class MatchStreamOf : public ::testing::TestWithParam<std::tuple<std::size_t, bool>> {};

TEST_P(MatchStreamOf, views_behind_air_or_water_finds_the_particles_and_what_the_cpu_lists) {
  const auto [views, tank] = GetParam();
  const ViewScene scene = testing::make_scene(views, 300, 0.1, views > 3 ? 0.08 : 0, tank);
  const auto rays = testing::rays_of(scene);
  const CorrespondenceOptions options = options_of(0.6);
  Correspondence cpu(rays, scene.volume, options);
  const auto listed = cpu.match(scene.detections);
  const MatchRig rig(rays, scene.volume, options);
  MatchStream stream(rig);
  std::vector<ViewMatch> first;
  for (const std::uint64_t seed : {0U, 3U}) {
    cuda_host::set_schedule_seed(seed);
    stream.submit(scene.detections);
    const auto chosen = stream.collect();
    ASSERT_EQ(stream.counts().failed, 0U) << take_cuda_error() << ": " << cuda_host::last_fault();
    std::size_t right = 0, known = 0;
    for (const ViewMatch& match : chosen) {
      right += std::any_of(scene.tuples.begin(), scene.tuples.end(),
                           [&](auto& truth) { return within(match.tuple, truth); });
      const auto same = std::find_if(listed.begin(), listed.end(), [&](auto& m) { return m.tuple == match.tuple; });
      if (same == listed.end()) continue;
      ++known;
      EXPECT_EQ(same->at_mm, match.at_mm);
      EXPECT_EQ(same->square_px2, match.square_px2);
      EXPECT_EQ(same->s, match.s);
    }
    std::size_t visible = 0;
    for (const ViewTuple& truth : scene.tuples) visible += truth.views >= options.min_views ? 1 : 0;
    EXPECT_GE(right, visible * 99 / 100);
    EXPECT_GE(known, chosen.size() * 99 / 100);
    EXPECT_LE(chosen.size(), visible + 3);
    for (std::size_t i = 0; i < chosen.size(); ++i)
      for (std::size_t k = 0; k < i; ++k) EXPECT_FALSE(share(chosen[i].tuple, chosen[k].tuple));
    if (first.empty()) first.assign(chosen.begin(), chosen.end());
    ASSERT_EQ(chosen.size(), first.size());
    for (std::size_t i = 0; i < chosen.size(); ++i) EXPECT_EQ(chosen[i].tuple, first[i].tuple);
  }
  cuda_host::set_schedule_seed(0);
  EXPECT_EQ(stream.counts().refused_pairs + stream.counts().refused_tuples + stream.counts().refused_matches, 0U);
}

INSTANTIATE_TEST_SUITE_P(rigs, MatchStreamOf, ::testing::Combine(::testing::Values(3, 4, 6), ::testing::Bool()));

TEST(MatchStream, keeps_two_frame_sets_in_flight_apart_in_the_memory_that_it_has) {
  const ViewScene even = testing::make_scene(4, 200, 0.1, 0.05, false, 1);
  const ViewScene odd = testing::make_scene(4, 150, 0.1, 0.05, false, 2);
  const auto rays = testing::rays_of(even);
  const MatchRig rig(rays, even.volume, options_of(0.6));
  MatchStream streams[]{MatchStream(rig), MatchStream(rig)};
  const std::size_t bytes = cuda_host::device_bytes_in_use();
  std::vector<ViewMatch> alone[2];
  for (std::size_t set = 0; set < 2; ++set) {
    streams[set].submit((set == 0 ? even : odd).detections);
    const auto chosen = streams[set].collect();
    alone[set].assign(chosen.begin(), chosen.end());
    EXPECT_GT(alone[set].size(), set == 0 ? 190U : 140U);
  }
  for (int repeat = 0; repeat < 3; ++repeat) {
    streams[0].submit(even.detections);
    streams[1].submit(odd.detections);
    for (std::size_t set = 0; set < 2; ++set) {
      const auto chosen = streams[set].collect();
      ASSERT_EQ(chosen.size(), alone[set].size());
      for (std::size_t i = 0; i < chosen.size(); ++i) EXPECT_EQ(chosen[i].tuple, alone[set][i].tuple);
    }
  }
  EXPECT_EQ(cuda_host::device_bytes_in_use(), bytes);
}

TEST(MatchStream, of_empty_views_finds_nothing) {
  const ViewScene scene = testing::make_scene(4, 0, 0.1);
  const auto rays = testing::rays_of(scene);
  const MatchRig rig(rays, scene.volume, options_of(0.6));
  MatchStream stream(rig);
  stream.submit(scene.detections);
  EXPECT_EQ(stream.collect().size(), 0U);
  EXPECT_EQ(stream.counts().failed, 0U);
  EXPECT_EQ(stream.collect().size(), 0U);  // nothing was submitted
  EXPECT_EQ(stream.counts().failed, 1U);
}

TEST(MatchStream, counts_what_it_has_no_room_for) {
  ViewScene scene = testing::make_scene(4, 0, 0.1);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> column(800, 1100), row(450, 750);
  for (Detections& seen : scene.detections) {
    seen = Detections(700);
    for (int i = 0; i < 700; ++i) seen.push({column(random), row(random), 0.1, 100, 9});
  }
  const auto rays = testing::rays_of(scene);
  CorrespondenceOptions options = options_of(12);
  options.max_detections = 500, options.max_matches = 60;
  const MatchRig rig(rays, scene.volume, options);
  MatchStream stream(rig);
  stream.submit(scene.detections);
  const auto chosen = stream.collect();
  EXPECT_EQ(stream.counts().failed, 0U) << take_cuda_error() << ": " << cuda_host::last_fault();
  EXPECT_EQ(stream.counts().unusable_detections, 4 * 200U);
  EXPECT_GT(stream.counts().refused_pairs, 0U);
  EXPECT_GT(stream.counts().refused_tuples, 0U);
  EXPECT_GT(stream.counts().refused_matches, 0U);
  EXPECT_GT(chosen.size(), 0U);
  EXPECT_LE(chosen.size(), 60U);
}

TEST(MatchStream, refuses_cameras_that_see_each_other) {
  ViewScene scene = testing::make_scene(3, 0, 0.1);
  for (const Point3 at : {Point3{3, -2, 1900}, Point3{-20, 15, 900}}) {
    CameraPose pose;
    pose.translation_mm = at;
    scene.rig.cameras.push_back({"along", CameraModel(scene.rig.cameras[0].model.intrinsics(), pose)});
  }
  const auto rays = testing::rays_of(scene);
  EXPECT_THROW(MatchRig(rays, scene.volume, options_of(0.6)), Error);
}

TEST(MatchStream, gives_its_device_memory_back) {
  const ViewScene scene = testing::make_scene(3, 10, 0.1);
  const auto rays = testing::rays_of(scene);
  const std::size_t before = cuda_host::device_bytes_in_use();
  {
    const MatchRig rig(rays, scene.volume, options_of(0.6));
    const MatchStream stream(rig);
    EXPECT_GT(cuda_host::device_bytes_in_use(), before);
  }
  EXPECT_EQ(cuda_host::device_bytes_in_use(), before);
}

}  // namespace
}  // namespace rptv
