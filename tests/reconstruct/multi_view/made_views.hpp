// SPDX-License-Identifier: MIT
// A rig of cameras round a volume, and what they see of random particles, with truth.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "calibration/cameras/rig.hpp"
#include "calibration/space_algebra.hpp"
#include "reconstruct/detection/detections.hpp"
#include "reconstruct/multi_view/view_match.hpp"
#include "reconstruct/multi_view/view_rays.hpp"

namespace rptv::testing {

struct ViewScene {
  Rig rig;
  Volume volume;
  std::vector<Point3> particles;  ///< rig's frame, mm
  std::vector<ViewTuple> tuples;  ///< of each particle: the detections that are its
  std::vector<Detections> detections;
};

/// Cameras of 1920 × 1200 px about 1.05 m from the origin, 4640 px focal length, some 20° off the z axis, distorted;
/// with `tank`, particles are in water behind 6 mm of glass at z = -110 mm.
inline Rig make_rig(std::size_t views, bool tank = false) {
  Rig rig;
  for (std::size_t v = 0; v < views; ++v) {
    const double turn = 2 * M_PI * (static_cast<double>(v) + 0.4) / static_cast<double>(views);
    const Point3 place{420 * std::cos(turn), 300 * std::sin(turn), -930 + 8 * static_cast<double>(v)};
    CameraPose pose;
    const Point3 forward = (-1 / norm(place)) * place, right = cross(Point3{0.05, 1, 0}, forward);
    pose.rotation[0] = (1 / norm(right)) * right;
    pose.rotation[1] = cross(forward, pose.rotation[0]);
    pose.rotation[2] = forward;
    pose.translation_mm = -1.0 * (pose.rotation * place);
    const CameraIntrinsics lens{1920, 1200, 4640, 4636, 965, 600, 0, -0.11, 0.13, 0, 2e-4, -4e-4, 0, 0};
    RefractiveStack stack;
    if (tank) stack = {{0, 0, -1}, {1}, {{110, {1.46}}, {104, {1.33}}}};
    rig.cameras.push_back({"view" + std::to_string(v), CameraModel(lens, pose, stack)});
  }
  return rig;
}

/// Particles at random in a cube of half-edge `half_mm` within the volume, detected with Gaussian errors; a view misses
/// a particle with probability `missed`. Detections of a view are shuffled.
inline void look(ViewScene& scene, std::size_t particles, double noise_px, double missed, unsigned seed,
                 double half_mm) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-half_mm, half_mm), chance(0, 1);
  std::normal_distribution<double> error(0, noise_px);
  for (std::size_t i = 0; i < particles; ++i) scene.particles.push_back({place(random), place(random), place(random)});
  scene.tuples.assign(particles, ViewTuple::none());
  scene.detections.clear();
  std::vector<std::size_t> order(particles);
  for (std::size_t i = 0; i < particles; ++i) order[i] = i;
  for (std::size_t v = 0; v < scene.rig.cameras.size(); ++v) {
    std::shuffle(order.begin(), order.end(), random);
    Detections& seen = scene.detections.emplace_back(particles);
    for (const std::size_t i : order) {
      const auto pixel = scene.rig.cameras[v].model.project(scene.particles[i]);
      if (chance(random) < missed || !pixel || !scene.rig.cameras[v].model.in_image(*pixel)) continue;
      scene.tuples[i].put(v, static_cast<std::uint32_t>(seen.size()));
      seen.push({(*pixel)[0] + error(random), (*pixel)[1] + error(random), noise_px, 1000, 9});
    }
  }
}

inline ViewScene make_scene(std::size_t views, std::size_t particles, double noise_px, double missed = 0,
                            bool tank = false, unsigned seed = 1, double half_mm = 100) {
  ViewScene scene{make_rig(views, tank), {{-100, -100, -100}, {100, 100, 100}}, {}, {}, {}};
  look(scene, particles, noise_px, missed, seed, half_mm);
  return scene;
}

inline std::vector<ViewRays> rays_of(const ViewScene& scene) {
  std::vector<ViewRays> rays;
  for (const RigCamera& camera : scene.rig.cameras) rays.emplace_back(camera.model, scene.volume, camera.name);
  return rays;
}

}  // namespace rptv::testing
