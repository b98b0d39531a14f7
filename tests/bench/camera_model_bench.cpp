// SPDX-License-Identifier: MIT
// What a projection and a sight ray cost, in air and through glass into water, per call on one core.
#include <benchmark/benchmark.h>

#include <vector>

#include "calibration/cameras/camera_model.hpp"

namespace rptv {
namespace {

/// Lens and tank of a laboratory: 5800 px, 600 mm away, 6 mm of glass.
CameraModel camera(bool distorted, bool refracted) {
  CameraIntrinsics lens{1280, 1024, 5800, 5800, 639.5, 511.5};
  if (distorted) lens.k1 = -0.2, lens.k2 = 0.5, lens.p1 = 1e-3, lens.p2 = -1e-3;
  const CameraPose pose{{{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}}, {0, 0, 600}};
  RefractiveStack stack;
  if (refracted) stack.interfaces = {{131, {1.46}}, {125, {1.33}}};
  return CameraModel(lens, pose, stack);
}

std::vector<Point3> points() {
  std::vector<Point3> grid;
  for (int i = 0; i < 512; ++i) grid.push_back({-40 + 10.0 * (i % 8), -35 + 10.0 * (i / 8 % 8), -40 + 10.0 * (i / 64)});
  return grid;
}

void project(benchmark::State& state, bool distorted, bool refracted, bool derived) {
  const CameraModel model = camera(distorted, refracted);
  const auto grid = points();
  PixelJacobian jacobian{};
  for (auto _ : state)
    for (const Point3& point : grid)
      benchmark::DoNotOptimize(derived ? model.project(point, jacobian) : model.project(point));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(grid.size()));
}

void ray(benchmark::State& state, bool distorted, bool refracted) {
  const CameraModel model = camera(distorted, refracted);
  for (auto _ : state)
    for (int i = 0; i < 512; ++i) benchmark::DoNotOptimize(model.ray({2.5 * i, 2.0 * i}));
  state.SetItemsProcessed(state.iterations() * 512);
}

BENCHMARK_CAPTURE(project, pinhole, false, false, false);
BENCHMARK_CAPTURE(project, distorted, true, false, false);
BENCHMARK_CAPTURE(project, refracted, true, true, false);
BENCHMARK_CAPTURE(project, refracted_with_derivative, true, true, true);
BENCHMARK_CAPTURE(ray, distorted, true, false);
BENCHMARK_CAPTURE(ray, refracted, true, true);

}  // namespace
}  // namespace rptv

BENCHMARK_MAIN();
