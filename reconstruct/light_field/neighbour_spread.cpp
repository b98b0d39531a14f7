// SPDX-License-Identifier: MIT
// The joint fit of the dense search, of particles that are found otherwise.
#include "reconstruct/light_field/neighbour_spread.hpp"

#include <algorithm>

namespace rptv {

namespace {

constexpr int kSteps = 4;
constexpr int kDepths = 9;
constexpr double kAnyLight = 1e30;
constexpr std::size_t kMostOverlap = 4;  // images on every pixel: more than lit pixels can part

JointFitOptions joint_options(const LightFieldCalibration& calibration, const ShakeOptions& options,
                              std::size_t mean_pixels) {
  auto joint = make_joint_fit_options(options, options.max_pixels, mean_pixels);
  const auto sensor = static_cast<std::size_t>(calibration.sensor.width_px * calibration.sensor.height_px);
  joint.max_entries = std::min(joint.max_entries, kMostOverlap * sensor);
  return joint;
}

// Over the depths of the volume, in the middle of the sensor.
std::size_t mean_pixels(const LightFieldCalibration& calibration, const LensletLattice& lattice,
                        const ShakeOptions& options) {
  ImageModel model(calibration, lattice, options.model);
  ParticleImage image(options.max_pixels);
  std::size_t sum = 0;
  for (int k = 0; k < kDepths; ++k) {
    const double z = options.lowest_z_mm + (options.highest_z_mm - options.lowest_z_mm) * k / (kDepths - 1);
    if (model.render({0, 0, z}, image)) sum += image.size;
  }
  return std::max<std::size_t>(sum / kDepths, 1);
}

}  // namespace

NeighbourSpread::NeighbourSpread(const LightFieldCalibration& calibration, const LensletLattice& lattice,
                                 const ShakeOptions& options)
    : fit_(calibration, lattice, joint_options(calibration, options, mean_pixels(calibration, lattice, options))),
      grey_(static_cast<std::size_t>(calibration.sensor.width_px * calibration.sensor.height_px)),
      spreads_(options.max_particles) {
  joint_.reserve(options.max_particles);
}

std::size_t NeighbourSpread::find(const ImageView& image, std::span<const float> background,
                                  std::span<FittedParticle> particles) noexcept {
  grey_above(image, background, grey_);
  fit_.begin(grey_);
  joint_.clear();
  for (const auto& p : particles) joint_.push_back({p.at, p.light});
  fit_.fit(joint_, {kSteps, kAnyLight, 0});
  fit_.find_spreads(joint_, spreads_);
  std::size_t rough = 0;
  for (std::size_t k = 0; k < particles.size(); ++k) {
    if (!(joint_[k].light > 0)) {  // no room for its image: it stays what it was
      ++rough;
      continue;
    }
    particles[k].at = joint_[k].at, particles[k].light = joint_[k].light, particles[k].shared = spreads_[k].shared;
    rough += spreads_[k].cut ? 1 : 0;
  }
  return rough;
}

}  // namespace rptv
