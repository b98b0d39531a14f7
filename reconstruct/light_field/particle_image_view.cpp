// SPDX-License-Identifier: MIT
// How far the borders of pupil, rims and cells are blurred for a particle, and how bright it is.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "reconstruct/light_field/particle_image.hpp"

namespace rptv {

namespace {
constexpr double kLeastSigmaMm = 1e-4;
}

ParticleView ImageModel::view_of(const ImagePoint& at) const noexcept {
  const bool finite = per_pupil_distance_ > 0;
  const double to_pupil = finite ? 1 / per_pupil_distance_ - at.z : 1;
  // A uniform disc has an rms of half its radius along an axis.
  const double particle_sigma = options_.particle_radius_mm / 2 * (1 + options_.radius_per_mm * at.z);
  const double particle_sigma_z = options_.particle_radius_mm / 2 * options_.radius_per_mm;
  const double cell_sigma = std::max(std::hypot(particle_sigma, at.z * slope_sigma_), kLeastSigmaMm);
  const double disc_share = particle_sigma * particle_sigma / (cell_sigma * cell_sigma);
  const double pupil_sigma = std::hypot(finite ? particle_sigma : 0, to_pupil * slope_sigma_);
  const double radius = options_.pupil_radius_mm;
  const double slope_area = std::numbers::pi * std::pow(focal_mm_ * radius / to_pupil, 2);
  ParticleView view{};
  view.x = static_cast<float>(at.x), view.y = static_cast<float>(at.y), view.z = static_cast<float>(at.z);
  view.cosine = static_cast<float>(lattice_.rotation_cosine());
  view.sine = static_cast<float>(lattice_.rotation_sine());
  view.half_pitch = static_cast<float>(lattice_.pitch_mm() / 2);
  view.edge = static_cast<float>(1 / (std::numbers::sqrt2 * cell_sigma));
  view.edge_z = static_cast<float>(-(at.z * slope_sigma_ * slope_sigma_ + particle_sigma * particle_sigma_z) /
                                   (cell_sigma * cell_sigma));
  view.flatness = static_cast<float>(-disc_share * disc_share / 24);
  view.to_pupil = static_cast<float>(to_pupil);
  view.with_position = finite ? 1.0F : 0.0F;
  // Blur moves the half-light contour of a disc inwards by σ²/(2R).
  view.pupil_radius = static_cast<float>(radius - pupil_sigma * pupil_sigma / (2 * radius));
  view.pupil_edge = static_cast<float>(1 / (std::numbers::sqrt2 * pupil_sigma));
  const double covariance =
      (finite ? particle_sigma * particle_sigma : 0) - slope_sigma_ * slope_sigma_ * at.z * to_pupil;
  view.rim_pull = static_cast<float>(covariance / (std::numbers::sqrt2 * pupil_sigma));
  view.light_z = finite ? static_cast<float>(-2 / to_pupil) : 0.0F;
  view.light = static_cast<float>(pixel_mm_ * pixel_mm_ / slope_area);
  view.has_rims = finite && !rim_shift_.empty();
  for (std::size_t k = 0; k < 2 && view.has_rims; ++k) view.rims[k] = rim_of(k, at, particle_sigma);
  return view;
}

// Where there is no such rim: a wide open one.
RimView ImageModel::rim_of(std::size_t k, const ImagePoint& at, double particle_sigma) const noexcept {
  if (k >= rim_shift_.size()) return {0, 1e6F, 1};
  const double shift = rim_shift_[k];
  const double sigma =
      std::hypot(particle_sigma * (1 + shift), slope_sigma_ * (1 / per_pupil_distance_ - (1 + shift) * at.z));
  return {static_cast<float>(shift), static_cast<float>(rim_radius_mm_[k]),
          static_cast<float>(1 / (std::numbers::sqrt2 * sigma))};
}

}  // namespace rptv
