// SPDX-License-Identifier: MIT
// The series for a rectangular duct, written so that large orders do not overflow.
#include "simulation/duct_flow.hpp"

#include <cmath>

namespace rptv {

namespace {
constexpr double kPi = std::numbers::pi;
constexpr double kMm3PerUl = 1, kSecondsPerMinute = 60;

/// u per pressure gradient over viscosity at (y, z) in |y| <= a, |z| <= b: plane Poiseuille flow between y = ±a, less
/// what the walls z = ±b hold back.
double expanded(double y, double z, double a, double b, int terms) {
  double sum = 0;
  for (int i = 2 * terms - 1; i > 0; i -= 2) {
    const double k = i * kPi / (2 * a);
    const double ratio =  // cosh(k z) / cosh(k b)
        std::exp(k * (z - b)) * (1 + std::exp(-2 * k * z)) / (1 + std::exp(-2 * k * b));
    sum += ((i / 2) % 2 == 0 ? ratio : -ratio) * std::cos(k * y) / (static_cast<double>(i) * i * i);
  }
  return 0.5 * (a * a - y * y) - 16 * a * a / (kPi * kPi * kPi) * sum;
}
}  // namespace

DuctFlow::DuctFlow(const DuctSettings& duct, int terms)
    : half_width_(0.5 * duct.width_mm), half_height_(0.5 * duct.height_mm), terms_(terms) {
  mean_ = duct.flow_rate_ul_min * kMm3PerUl / kSecondsPerMinute / (duct.width_mm * duct.height_mm);
  // The mean of u per pressure gradient over viscosity, from the flow rate's own series (White, eq. 3-48).
  double sum = 0;
  for (int i = 2 * terms - 1; i > 0; i -= 2)  // the small terms first
    sum += std::tanh(i * kPi * half_height_ / (2 * half_width_)) / std::pow(i, 5);
  const double mean = half_width_ * half_width_ / 3 * (1 - 192 * half_width_ / (std::pow(kPi, 5) * half_height_) * sum);
  scale_ = mean_ / mean;
}

double DuctFlow::velocity_mm_s(double y_mm, double z_mm) const noexcept {
  const double y = std::abs(y_mm), z = std::abs(z_mm);
  if (y >= half_width_ || z >= half_height_) return 0;
  // Expanded across the side whose other walls are far: the terms then fall off exponentially.
  const bool across_width = (half_height_ - z) * half_height_ >= (half_width_ - y) * half_width_;
  return scale_ * (across_width ? expanded(y, z, half_width_, half_height_, terms_)
                                : expanded(z, y, half_height_, half_width_, terms_));
}

double DuctFlow::fastest_mm_s() const noexcept { return std::abs(velocity_mm_s(0, 0)); }

}  // namespace rptv
