// SPDX-License-Identifier: MIT
// Steps of all particles, and what each view's particle images look like.
#include "reconstruct/multi_view/shaken_particles.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "calibration/space_algebra.hpp"
#include "reconstruct/multi_view/particle_step.hpp"
#include "reconstruct/parallel.hpp"

namespace rptv {

namespace {

constexpr double kNarrowest_px = 0.25, kWidest_px = 3.4;
constexpr double kMostStep_px = 0.7;

}  // namespace

ShakenParticles::ShakenParticles(std::vector<CameraModel> models, std::vector<ResidualView> views, const Volume& volume,
                                 const Options& options)
    : models_(std::move(models)),
      views_(std::move(views)),
      volume_(volume),
      capacity_(options.capacity),
      threads_(options.threads),
      sigma_px_(views_.size(), options.sigma_px),
      gain_(views_.size(), 1.0) {
  particles_.reserve(capacity_);
  misfits_.resize(views_.size());
  for (auto& misfit : misfits_) misfit.resize(capacity_);
  greys_.resize(capacity_), order_.resize(capacity_), kept_.resize(capacity_);
  spots_.resize(views_.size());
  for (auto& spots : spots_) spots.resize(capacity_);
  for (const CameraModel& model : models_) {
    PixelJacobian jacobian{};
    model.project(volume_.centre(), jacobian);
    px_per_mm_ += std::sqrt((dot(jacobian[0], jacobian[0]) + dot(jacobian[1], jacobian[1])) / 2) /
                  static_cast<double>(models_.size());
  }
}

bool ShakenParticles::push(const Point3& at_mm, float grey) noexcept {
  if (particles_.size() == capacity_) return false;
  particles_.push_back({at_mm, grey, grey});
  return true;
}

ViewSpot ShakenParticles::spot_of(const ShakenParticle& particle, std::size_t view, double sigma_px) const noexcept {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const auto pixel = models_[view].project(particle.at_mm);
  if (!pixel) return {kNan, kNan, 1, 0};
  return {static_cast<float>((*pixel)[0]), static_cast<float>((*pixel)[1]), static_cast<float>(sigma_px),
          static_cast<float>(particle.grey * gain_[view])};
}

void ShakenParticles::subtract(std::size_t view, double sigma_px) noexcept {
  auto& spots = spots_[view];
  for (std::size_t i = 0; i < particles_.size(); ++i) spots[i] = spot_of(particles_[i], view, sigma_px);
  views_[view].restore();
  views_[view].subtract({spots.data(), particles_.size()});
}

void ShakenParticles::subtract() noexcept {
  parallel_for(views_.size(), threads_, [&](std::size_t view, std::size_t) { subtract(view, sigma_px_[view]); });
}

void ShakenParticles::step(ShakenParticle& particle) const noexcept {
  ParticleStep step;
  double weakest = HUGE_VAL, square_px2 = 0;
  particle.views = 0;
  for (std::size_t v = 0; v < views_.size(); ++v) {
    PixelJacobian jacobian;
    const auto pixel = models_[v].project(particle.at_mm, jacobian);
    if (!pixel) continue;
    const ViewSpot spot{static_cast<float>((*pixel)[0]), static_cast<float>((*pixel)[1]),
                        static_cast<float>(sigma_px_[v]), particle.grey};
    if (!views_[v].near(spot)) continue;
    const SpotSums sums = views_[v].sums(spot);
    step.add(sums, jacobian, particle.grey, gain_[v]);
    if (!models_[v].in_image(*pixel) || !(sums.mm > 0)) continue;
    ++particle.views;
    const double light = particle.grey * gain_[v];
    weakest = std::min(weakest, particle.grey + sums.mr / (sums.mm * gain_[v]));
    if (sums.uu > 0 && sums.vv > 0)
      square_px2 += std::pow(sums.ur / (light * sums.uu), 2) + std::pow(sums.vr / (light * sums.vv), 2);
  }
  step.solve(1 / px_per_mm_);
  const double length_px = norm(step.shift_mm()) * px_per_mm_;
  const double part = std::min(1.0, kMostStep_px / std::max(length_px, 1e-9));
  particle.at_mm = particle.at_mm + part * step.shift_mm();
  particle.grey = static_cast<float>(std::max(0.0, particle.grey + part * step.more_grey()));
  particle.weakest = weakest < HUGE_VAL ? static_cast<float>(weakest) : 0;
  particle.miss_px = std::sqrt(square_px2 / std::max(2U * particle.views, 1U));
  particle.covariance_mm2 = step.covariance_mm2();
}

// Neighbours that move together against the same residual overshoot together: a fraction of all moves at a time, and
// the fractions differ from sweep to sweep.
void ShakenParticles::sweep() noexcept {
  constexpr std::array<std::size_t, 3> kParts{3, 4, 5};
  const std::size_t parts = kParts[sweeps_++ % kParts.size()];
  for (std::size_t part = 0; part < parts; ++part) {
    const std::size_t count = (particles_.size() + parts - 1 - part) / parts;
    parallel_for((count + kBlock - 1) / kBlock, threads_, [&](std::size_t block, std::size_t) {
      const std::size_t last = std::min((block + 1) * kBlock, count);
      for (std::size_t i = block * kBlock; i < last; ++i) step(particles_[part + i * parts]);
    });
    parallel_for(views_.size(), threads_, [&](std::size_t view, std::size_t) {
      for (std::size_t i = part; i < particles_.size(); i += parts) {
        std::array<ViewSpot, 2> change{spots_[view][i], spot_of(particles_[i], view, sigma_px_[view])};
        spots_[view][i] = change[1];
        change[0].grey = -change[0].grey;
        views_[view].subtract(change);
      }
    });
  }
}

std::size_t ShakenParticles::keep() noexcept {
  std::size_t count = 0;
  for (std::size_t i = 0; i < particles_.size(); ++i)
    if (kept_[i] != 0) particles_[count++] = particles_[i];
  const std::size_t went = particles_.size() - count;
  particles_.resize(count);
  return went;
}

// Where others overlap that are not known yet, images look wide: the quarter that is explained best tells. With the
// light fitted, the derivative by the width is the image's times (ρ²/2σ² - 1)/σ, of mean square Σm²/σ² (ρ: distance
// from the centre, σ: with the pixel).
void ShakenParticles::fit_image(std::size_t view) noexcept {
  constexpr double kStep = 0.05, kMost = 0.1, kPixelVariance = 1.0 / 12;
  const double sigma = sigma_px_[view], whole = sigma * sigma + kPixelVariance;
  const double per_square = sigma * sigma / (whole * whole);
  auto& misfit = misfits_[view];
  std::size_t count = 0;
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    const ViewSpot& spot = spots_[view][i];
    if (views_[view].near(spot)) misfit[count++] = views_[view].sums(spot).rr;
  }
  if (count < kTellingParticles) return;
  const auto quarter = misfit.begin() + static_cast<std::ptrdiff_t>(count / 4);
  std::nth_element(misfit.begin(), quarter, misfit.begin() + static_cast<std::ptrdiff_t>(count));
  double more = 0, wider = 0, all = 0;
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    ViewSpot spot = spots_[view][i];
    if (!views_[view].near(spot)) continue;
    const SpotSums sums = views_[view].sums(spot);
    if (sums.rr > *quarter) continue;
    const auto grey = static_cast<double>(spot.grey);
    spot.sigma_px = static_cast<float>(sigma * (1 + kStep));
    const auto wide = static_cast<double>(views_[view].sums(spot).mr);
    spot.sigma_px = static_cast<float>(sigma * (1 - kStep));
    const auto narrow = static_cast<double>(views_[view].sums(spot).mr);
    more += grey * static_cast<double>(sums.mr), all += grey * grey * static_cast<double>(sums.mm);
    wider += grey * (wide - narrow) / (2 * kStep * sigma);
  }
  if (!(all > 0)) return;
  const double change = 0.5 * wider / (all * per_square);
  sigma_px_[view] = std::clamp(sigma + std::clamp(change, -kMost * sigma, kMost * sigma), kNarrowest_px, kWidest_px);
  gain_[view] *= std::clamp(1 + more / all, 0.8, 1.25);
}

void ShakenParticles::fit_images() noexcept {
  parallel_for(views_.size(), threads_, [&](std::size_t view, std::size_t) { fit_image(view); });
  double mean = 0;
  for (const double gain : gain_) mean += gain / static_cast<double>(gain_.size());
  for (double& gain : gain_) gain /= mean;
  subtract();
}

float ShakenParticles::median_grey() noexcept {
  const std::size_t count = particles_.size();
  if (count == 0) return 0;
  for (std::size_t i = 0; i < count; ++i) greys_[i] = particles_[i].grey;
  const auto half = greys_.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(greys_.begin(), half, greys_.begin() + static_cast<std::ptrdiff_t>(count));
  return *half;
}

bool ShakenParticles::inside(const Point3& at_mm) const noexcept {
  bool inside = true;
  for (std::size_t k = 0; k < 3; ++k) inside = inside && at_mm[k] >= volume_.from[k] && at_mm[k] <= volume_.to[k];
  return inside;
}

std::size_t ShakenParticles::drop(double share, double apart_px) noexcept {
  const std::size_t count = particles_.size();
  const auto least = static_cast<float>(share) * median_grey();
  for (std::size_t i = 0; i < count; ++i) {
    order_[i] = static_cast<std::uint32_t>(i);
    kept_[i] = particles_[i].grey >= least && particles_[i].weakest >= least && inside(particles_[i].at_mm) ? 1 : 0;
  }
  const auto last = order_.begin() + static_cast<std::ptrdiff_t>(count);
  std::sort(order_.begin(), last, [&](auto a, auto b) {
    return particles_[a].at_mm[0] != particles_[b].at_mm[0] ? particles_[a].at_mm[0] < particles_[b].at_mm[0] : a < b;
  });
  const double apart_mm = apart_px / px_per_mm_;
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = i + 1; k < count; ++k) {
      const auto &a = particles_[order_[i]], &b = particles_[order_[k]];
      if (b.at_mm[0] - a.at_mm[0] > apart_mm || kept_[order_[i]] == 0) break;
      if (kept_[order_[k]] == 0 || norm(b.at_mm - a.at_mm) > apart_mm) continue;
      kept_[a.grey < b.grey ? order_[i] : order_[k]] = 0;
    }
  return keep();
}

}  // namespace rptv
