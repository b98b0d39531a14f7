// SPDX-License-Identifier: MIT
// The halves move apart until the image would tell.
#include "reconstruct/light_field/pair_spread.hpp"

#include <algorithm>
#include <cmath>

namespace rptv {

namespace {

constexpr double kPairLight = 1.4;  // of the median particle's, at least
constexpr double kPairSigmas = 3;   // by how much more its logarithm must be
constexpr double kSigmaOfMedian = 1.4826;
constexpr double kFirstPitches = 0.01, kMostPitches = 1, kFarther = 1.4;

float median(std::span<float> values) noexcept {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

ImagePoint aside(const ImagePoint& at, const ImagePoint& half, double side) noexcept {
  return {at.x + side * half.x, at.y + side * half.y, at.z + side * half.z};
}

}  // namespace

PairSpread::PairSpread(const LightFieldCalibration& calibration, const LensletLattice& lattice,
                       const ShakeOptions& options)
    : options_(options),
      chief_(calibration),
      model_(calibration, lattice, options.model),
      one_(options.max_pixels),
      half_(options.max_pixels),
      halves_(static_cast<std::size_t>(calibration.sensor.width_px * calibration.sensor.height_px)) {
  lights_.reserve(options.max_particles);
}

double PairSpread::least_light(std::span<const FittedParticle> particles) noexcept {
  lights_.clear();
  for (const auto& p : particles) lights_.push_back(static_cast<float>(p.light));
  const float typical = median(lights_);
  for (float& light : lights_) light = std::abs(std::log(light / typical));
  const double sigma = kSigmaOfMedian * static_cast<double>(median(lights_));
  return static_cast<double>(typical) * std::max(kPairLight, std::exp(kPairSigmas * sigma));
}

// False when one of them has no image; what was added stays.
bool PairSpread::add_halves(const FittedParticle& pair, const ImagePoint& half) noexcept {
  bool seen = true;
  for (const double side : {1.0, -1.0}) {
    seen = model_.render(aside(pair.at, half, side), half_) && seen;
    for (std::size_t i = 0; i < half_.size; ++i)
      halves_[half_.pixel[i]] += static_cast<float>(pair.light) / 2 * half_.value[i];
  }
  return seen;
}

void PairSpread::clear_halves(const FittedParticle& pair, const ImagePoint& half) noexcept {
  for (const double side : {1.0, -1.0}) {
    model_.render(aside(pair.at, half, side), half_);
    for (std::size_t i = 0; i < half_.size; ++i) halves_[half_.pixel[i]] = 0;
  }
}

// Along `direction`, in units of it: where two would explain so much less than one as is left unexplained, or as two
// would need to explain more to be found.
double PairSpread::half_distance(const FittedParticle& pair, const ImagePoint& direction,
                                 std::span<const float> explained) noexcept {
  const auto light = static_cast<float>(pair.light);
  const auto dark = static_cast<float>(options_.dark_noise_grey * options_.dark_noise_grey + 1.0 / 12),
             per_grey = static_cast<float>(1 / options_.electrons_per_grey);
  const double enough = std::max(kLeastGain, (pair.chi_square - 1) * static_cast<double>(one_.size));
  double half = kFirstPitches * options_.pitch_mm;
  for (; half < kMostPitches * options_.pitch_mm; half *= kFarther) {
    const ImagePoint to{half * direction.x, half * direction.y, half * direction.z};
    const bool seen = add_halves(pair, to);
    double square = 0;
    for (std::size_t i = 0; i < one_.size; ++i) {
      const float off = halves_[one_.pixel[i]] - light * one_.value[i];
      square += static_cast<double>(off * off / (dark + per_grey * std::max(explained[one_.pixel[i]], 0.0F)));
    }
    clear_halves(pair, to);
    if (!seen || square > enough) break;
  }
  return half;
}

void PairSpread::widen(std::span<FittedParticle> particles, std::span<const float> explained) noexcept {
  if (particles.empty()) return;
  const double least = least_light(particles), per_slope = 1 / options_.slope_rms;
  for (auto& p : particles) {
    if (!(p.light > least) || !model_.render(p.at, one_)) continue;
    const ImagePoint chief = chief_.direction(p.at);
    const double x = half_distance(p, {1, 0, 0}, explained), y = half_distance(p, {0, 1, 0}, explained);
    const double z = per_slope * half_distance(p, {chief.x * per_slope, chief.y * per_slope, per_slope}, explained);
    auto& c = p.covariance;
    c = {c.xx + x * x + z * z * chief.x * chief.x, c.xy + z * z * chief.x * chief.y, c.xz + z * z * chief.x,
         c.yy + y * y + z * z * chief.y * chief.y, c.yz + z * z * chief.y,           c.zz + z * z};
  }
}

}  // namespace rptv
