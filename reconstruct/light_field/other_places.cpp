// SPDX-License-Identifier: MIT
// Many starts, of which the best are climbed from; maxima at which two arrive count once.
#include "reconstruct/light_field/other_places.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace rptv {

namespace {

constexpr std::array<double, 3> kAside{-1.0 / 3, 0, 1.0 / 3};  // pitches
constexpr std::array<double, 3> kDeeper{-0.15, 0, 0.15};       // shallow depths
constexpr std::size_t kStarts = 9 * (3 + 1);
constexpr std::size_t kMostClimbs = 6;
constexpr int kSteps = 6;
constexpr double kStill = 0.02;           // a step that promises less χ² than this ends a climb
constexpr double kSamePlace = 1;          // squared distance in standard deviations
constexpr double kLeastVariance = 1e-14;  // mm²
constexpr double kUnlikely = 20;          // χ² below the best: no matter

Eigen::Matrix3d matrix_of(const FitCovariance& c) noexcept {
  Eigen::Matrix3d m;
  m << c.xx, c.xy, c.xz, c.xy, c.yy, c.yz, c.xz, c.yz, c.zz;
  return m;
}

// In coordinates of like size, so that depth does not drown the others.
FitCovariance positive_part(const Eigen::Matrix3d& m) noexcept {
  const Eigen::Vector3d scale = m.diagonal().cwiseAbs().cwiseMax(kLeastVariance).cwiseSqrt();
  const Eigen::Vector3d per = scale.cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(per.asDiagonal() * m * per.asDiagonal());
  const Eigen::Matrix3d turned = scale.asDiagonal() * solver.eigenvectors();
  const Eigen::Matrix3d p = turned * solver.eigenvalues().cwiseMax(0).asDiagonal() * turned.transpose();
  return {p(0, 0), p(0, 1), p(0, 2), p(1, 1), p(1, 2), p(2, 2)};
}

Eigen::Vector3d between(const FittedParticle& a, const FittedParticle& b) noexcept {
  return {a.at.x - b.at.x, a.at.y - b.at.y, a.at.z - b.at.z};
}

}  // namespace

OtherPlaces::OtherPlaces(const LightFieldCalibration& calibration, const LensletLattice& lattice,
                         const ShakeOptions& options, std::size_t max_pixels)
    : options_(options),
      chief_(calibration),
      model_(calibration, lattice, options.model),
      own_(max_pixels),
      now_(max_pixels),
      own_light_(static_cast<std::size_t>(calibration.sensor.width_px * calibration.sensor.height_px)),
      grey_(max_pixels),
      others_(max_pixels) {
  places_.reserve(kStarts + 1);
}

bool OtherPlaces::near_array(const FittedParticle& particle) const noexcept {
  return particle.light > 0 && std::abs(particle.at.z) < options_.shallow_mm;
}

Seen OtherPlaces::look(const ParticleImage& image, const JointView& view) noexcept {
  for (std::size_t i = 0; i < image.size; ++i) {
    const std::uint32_t pixel = image.pixel[i];
    others_[i] = std::max(view.explained[pixel] - own_light_[pixel], 0.0F);
    grey_[i] = view.grey[pixel] - others_[i];
  }
  return {grey_.data(), others_.data(),
          static_cast<float>(options_.dark_noise_grey * options_.dark_noise_grey + 1.0 / 12),
          static_cast<float>(1 / options_.electrons_per_grey), 0};
}

bool OtherPlaces::weigh(Place& place, ParticleImage& image, const JointView& view) noexcept {
  auto& particle = place.particle;
  if (particle.at.z < options_.lowest_z_mm || particle.at.z > options_.highest_z_mm ||
      !model_.render(particle.at, image))
    return false;
  const Seen seen = look(image, view);
  if (!(particle.light > 0)) particle.light = best_light(image, seen).light;
  if (!(particle.light > 0)) return false;
  place.sums = sum_up(image, seen, particle.light);
  return true;
}

void OtherPlaces::climb(Place& place, const JointView& view) noexcept {
  double damping = 1e-3;
  for (int tries = 0, done = 0; done < kSteps && tries < 2 * kSteps; ++tries) {
    Place next = place;
    if (!(take_step(place.sums, damping, next.particle) > kStill)) return;
    const bool better = next.particle.light > 0 && weigh(next, now_, view) && next.sums.gain >= place.sums.gain;
    if (better) place = next, ++done;
    damping = better ? damping * 0.2 : std::max(damping * 20, 1e-2);
  }
}

void OtherPlaces::add_start(const ImagePoint& at, const JointView& view) noexcept {
  Place start;
  start.particle.at = at;
  if (weigh(start, now_, view)) places_.push_back(start);
}

// All maxima, that of the particle itself first; covariances of positions with all others known.
void OtherPlaces::find(const FittedParticle& particle, const JointView& view) noexcept {
  places_.clear();
  if (!model_.render(particle.at, own_)) return;
  const auto light = static_cast<float>(particle.light);
  for (std::size_t i = 0; i < own_.size; ++i) own_light_[own_.pixel[i]] = light * own_.value[i];
  Place self{particle, {}};
  if (weigh(self, now_, view)) {
    places_.push_back(self);
    for (std::size_t depth = 0; depth <= kDeeper.size(); ++depth) {
      const double z = depth < kDeeper.size() ? particle.at.z + kDeeper[depth] * options_.shallow_mm : -particle.at.z;
      const ImagePoint on_ray = chief_.slide(particle.at, z);
      for (const double x : kAside)
        for (const double y : kAside)
          add_start({on_ray.x + x * options_.pitch_mm, on_ray.y + y * options_.pitch_mm, z}, view);
    }
    std::sort(places_.begin() + 1, places_.end(),
              [](const Place& a, const Place& b) { return a.sums.gain > b.sums.gain; });
    places_.resize(std::min(places_.size(), kMostClimbs + 1));
    for (auto& place : places_) {
      climb(place, view);
      place.particle.gain = place.sums.gain;
      place.particle.covariance = covariance_of(place.sums, 1, 0, 1, {0, 0, 1});
    }
  }
  for (std::size_t i = 0; i < own_.size; ++i) own_light_[own_.pixel[i]] = 0;
}

double OtherPlaces::improve(FittedParticle& particle, const JointView& view) noexcept {
  if (!near_array(particle)) return 0;
  find(particle, view);
  if (places_.empty()) return 0;
  const auto best = std::max_element(places_.begin(), places_.end(),
                                     [](const Place& a, const Place& b) { return a.particle.gain < b.particle.gain; });
  const double gain = best->particle.gain - places_[0].particle.gain;
  if (gain > 0) particle.at = best->particle.at, particle.light = best->particle.light;
  return gain;
}

FitCovariance OtherPlaces::ambiguity(const FittedParticle& particle, const JointView& view) noexcept {
  if (!near_array(particle)) return {};
  find(particle, view);
  if (places_.empty()) return {};
  const Eigen::Matrix3d alone = matrix_of(places_[0].particle.covariance);
  std::sort(places_.begin(), places_.end(),
            [](const Place& a, const Place& b) { return a.particle.gain > b.particle.gain; });
  std::size_t count = 0;
  double all = 0;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Place& place : places_) {
    const Eigen::Matrix3d own = matrix_of(place.particle.covariance);
    const bool known =
        std::any_of(places_.begin(), places_.begin() + static_cast<std::ptrdiff_t>(count), [&](const Place& other) {
          const Eigen::Vector3d d = between(place.particle, other.particle);
          return d.dot(matrix_of(other.particle.covariance).ldlt().solve(d)) < kSamePlace;
        });
    const double below = places_[0].particle.gain - place.particle.gain;
    if (known || below > kUnlikely) continue;
    const double share = std::exp(-below / 2) * std::sqrt(std::max(own.determinant(), 0.0));
    const Eigen::Vector3d d = between(place.particle, particle);
    spread += share * (own + d * d.transpose());
    all += share;
    places_[count++] = place;
  }
  return all > 0 ? positive_part(spread / all - alone) : FitCovariance{};
}

}  // namespace rptv
