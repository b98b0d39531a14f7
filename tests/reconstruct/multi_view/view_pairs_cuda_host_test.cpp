// SPDX-License-Identifier: MIT
// The device's pairs of detections against those that the CPU's epipolar pencil visits: the same, with the same depths.
#include "reconstruct/multi_view/view_pairs_cuda.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "reconstruct/multi_view/asked_place_kernel.hpp"
#include "reconstruct/multi_view/epipolar_pencil.hpp"
#include "tests/reconstruct/multi_view/made_views.hpp"
#include "tests/reconstruct/on_device.hpp"

namespace rptv {
namespace {

using testing::OnDevice;
using testing::ViewScene;

using Pair = std::tuple<std::uint32_t, std::uint32_t, double>;  ///< detections, depth

/// Two views of a scene and what they saw.
struct Views {
  Views(const ViewScene& scene, double by_px)
      : rays(testing::rays_of(scene)), half_mm(scene.volume.to - scene.volume.centre()) {
    for (std::size_t v = 0; v < 2; ++v) {
      seen.emplace_back(rays[v], 4096, 1000, true);
      seen[v].look(scene.detections[v]);
    }
    lines = PencilOfLines(rays[0], rays[1]);
    error_px = across_px(by_px, rays[1].px_per_mm(), rays[0].px_per_mm());
  }
  bool settled(std::size_t view, std::size_t detection) const { return (detection + view) % 11 == 3; }

  std::vector<ViewRays> rays;
  std::vector<SeenView> seen;
  Point3 half_mm;
  PencilOfLines lines;
  double error_px;
};

std::vector<Pair> by_cpu(const Views& views) {
  std::vector<Pair> pairs;
  EpipolarPencil pencil(4096);
  pencil.build(views.lines, views.seen[1]);
  const double wander_px = views.rays[1].wander_px();
  for (std::uint32_t i = 0; i < views.seen[0].size(); ++i) {
    Sight sight;
    if (!views.seen[0].usable(i) || views.settled(0, i)) continue;
    views.seen[0].sight(i, sight.from_mm, sight.along);
    if (!clip(views.half_mm, sight)) continue;
    pencil.visit_near(EpipolarLine(views.rays[1].pinhole(), sight), sight, views.error_px + wander_px,
                      [&](std::uint32_t found, double t) {
                        if (views.settled(1, found)) return;
                        if (wander_px > kNoWander_px) {
                          Point3 from_mm, along;
                          views.seen[1].sight(found, from_mm, along);
                          t = nearest_depth(sight, from_mm, along);
                          const auto miss =
                              miss_px(views.seen[1].ray(found), views.rays[1].axes(), sight.from_mm + t * sight.along);
                          if (miss[0] * miss[0] + miss[1] * miss[1] > views.error_px * views.error_px) return;
                        }
                        pairs.emplace_back(i, found, t);
                      });
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

/// A view on the device.
struct SeenOnDevice {
  SeenOnDevice(const Views& views, std::size_t view)
      : count(static_cast<std::uint32_t>(views.seen[view].size())),
        ray({views.seen[view].rays_begin(), views.seen[view].rays_begin() + count}),
        u({views.seen[view].u_begin(), views.seen[view].u_begin() + count}),
        v({views.seen[view].v_begin(), views.seen[view].v_begin() + count}),
        settled(flags(views, view)) {}
  static std::vector<std::uint32_t> flags(const Views& views, std::size_t view) {
    std::vector<std::uint32_t> flags(views.seen[view].size());
    for (std::size_t i = 0; i < flags.size(); ++i) flags[i] = views.settled(view, i) ? 1 : 0;
    return flags;
  }
  CudaSeen view() const { return {ray.data(), u.data(), v.data(), settled.data(), count}; }

  std::uint32_t count;
  OnDevice<SeenRay> ray;
  OnDevice<double> u, v;
  OnDevice<std::uint32_t> settled;
};

struct Found {
  std::vector<Pair> pairs;
  std::uint32_t count;
};

Found by_device(const Views& views, std::uint32_t capacity, unsigned threads) {
  const SeenOnDevice first(views, 0), second(views, 1);
  const std::vector<std::uint32_t> nothing(std::max(second.count, 1U) + 2, 77), room(capacity);
  const OnDevice<std::uint32_t> start(nothing), bin(nothing), entry(nothing), of_first(room), of_second(room),
      count({5});
  const OnDevice<double> depth(std::vector<double>(capacity, 0));
  CudaStream stream;
  EXPECT_TRUE(find_pairs_cuda(
      {first.view(), second.view(), views.rays[0].axes(), views.rays[1].axes(), views.rays[1].pinhole(), views.lines,
       views.half_mm, views.error_px, views.rays[1].wander_px()},
      {start.data(), bin.data(), entry.data()},
      {of_first.data(), of_second.data(), depth.data(), count.data(), capacity}, stream.handle(), threads));
  Found found{{}, count.read(stream)[0]};
  const auto firsts = of_first.read(stream), seconds = of_second.read(stream);
  const auto depths = depth.read(stream);
  for (std::size_t i = 0; i < std::min(found.count, capacity); ++i)
    found.pairs.emplace_back(firsts[i], seconds[i], depths[i]);
  std::sort(found.pairs.begin(), found.pairs.end());
  return found;
}

class ViewPairsCuda : public ::testing::TestWithParam<bool> {};

TEST_P(ViewPairsCuda, behind_air_or_water_are_those_of_the_cpu_with_every_schedule) {
  const Views views(testing::make_scene(3, 397, 0.3, 0.1, GetParam()), 1.5);
  const auto expected = by_cpu(views);
  EXPECT_GT(expected.size(), 500U);
  testing::with_every_schedule([&](unsigned threads) {
    const Found found = by_device(views, 20000, threads);
    EXPECT_EQ(found.count, expected.size());
    EXPECT_EQ(found.pairs, expected);
  });
}

INSTANTIATE_TEST_SUITE_P(media, ViewPairsCuda, ::testing::Bool());

TEST(ViewPairsCuda, beyond_the_room_are_counted_and_none_is_made_up) {
  const Views views(testing::make_scene(3, 150, 0.3), 0.6);
  const auto expected = by_cpu(views);
  testing::with_every_schedule([&](unsigned threads) {
    const Found found = by_device(views, 41, threads);
    EXPECT_EQ(found.count, expected.size());
    EXPECT_EQ(found.pairs.size(), 41U);
    EXPECT_TRUE(std::includes(expected.begin(), expected.end(), found.pairs.begin(), found.pairs.end()));
  });
}

TEST(ViewPairsCuda, of_what_is_beyond_the_images_or_not_there_are_none) {
  ViewScene scene = testing::make_scene(3, 20, 0.3);
  for (double& column : scene.detections[1].x_px) column = 5000;
  EXPECT_EQ(by_device(Views(scene, 0.6), 100, 32).count, 0U);
  scene.detections[1].clear();
  EXPECT_EQ(by_device(Views(scene, 0.6), 100, 32).count, 0U);
  EXPECT_EQ(by_device(Views(testing::make_scene(3, 0, 0.3), 0.6), 100, 96).count, 0U);
}

}  // namespace
}  // namespace rptv
