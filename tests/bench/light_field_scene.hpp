// SPDX-License-Identifier: MIT
// Images whose particles are known, as the light-field benchmarks use them: simulated, or from the shared sets.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/particles.hpp"
#include "reconstruct/light_field/cramer_rao.hpp"
#include "reconstruct/light_field/light_field.hpp"
#include "reconstruct/light_field/shake_options.hpp"
#include "simulation/scenario.hpp"

namespace rptv::bench {

/// One image. Everything in image space.
struct KnownScene {
  std::string name;
  LightFieldCalibration calibration;
  LightFieldSettings settings;  ///< fit for the camera; refine is off
  ImageShape shape;
  std::vector<std::byte> pixels;
  std::vector<BrightPoint> truth;  ///< all that light the sensor, also in part
  std::vector<char> in_view;       ///< whole image on the sensor

  ImageView view() const noexcept { return {pixels.data(), shape}; }
};

/// Frame `frame` of a scenario; truth is where the real rays converge.
KnownScene simulated_scene(const std::string& name, const ScenarioSettings& scenario, std::uint64_t frame);

/// An image of all planes of the shared sets lf-macro and lf-edge; none where RPTV_SHARED_DATA does not name their
/// folder.
std::optional<KnownScene> double_gauss_scene(const std::string& set, const std::string& image);
/// A frame of the shared set lf-wall.
std::optional<KnownScene> wall_scene(std::uint64_t frame);

/// Small cameras with a thick lens and thin lenslets: the wall's optics, particles in random places of a cube.
ScenarioSettings random_scenario();

/// The same camera, smaller, and so many particles per lenslet of the picture of a box 2 mm wide and `depth_mm` deep.
ScenarioSettings dense_scenario(double per_lenslet, double depth_mm);

/// What refinement works with in a scene.
ShakeOptions shake_options_of(const KnownScene& scene);

/// The Cramér-Rao bound of every true particle, with the model and the noise that refinement works with.
std::vector<FitCovariance> bounds_of(const KnownScene& scene);

/// A found particle and the true one that it is; one to one, nearest first. The default limits are wide: two pitches
/// aside, 3 mm of image depth.
struct KnownMatch {
  std::size_t found, truth;
};
std::vector<KnownMatch> match(const Particles& found, const KnownScene& scene, double lateral_mm = 0.25,
                              double depth_mm = 3);

}  // namespace rptv::bench
