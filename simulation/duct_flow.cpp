// SPDX-License-Identifier: MIT
// The series for a rectangular duct, written so that large orders do not overflow.
#include "simulation/duct_flow.hpp"

#include <cmath>

namespace rptv {

namespace {
constexpr double kPi = std::numbers::pi;
constexpr double kMm3PerUl = 1, kSecondsPerMinute = 60;
}  // namespace

DuctFlow::DuctFlow(const DuctSettings& duct, int terms)
    : half_width_(0.5 * duct.width_mm), half_height_(0.5 * duct.height_mm), terms_(terms) {
  mean_ = duct.flow_rate_ul_min * kMm3PerUl / kSecondsPerMinute / (duct.width_mm * duct.height_mm);
  // Mean of the bare series over the cross-section.
  double sum = 0;
  for (int i = 2 * terms - 1; i > 0; i -= 2) {  // the small terms first
    const double q = i * kPi * half_height_ / (2 * half_width_);
    sum += (1 - std::tanh(q) / q) * 2 / (kPi * std::pow(i, 4));
  }
  scale_ = mean_ / sum;
}

double DuctFlow::velocity_mm_s(double y_mm, double z_mm) const noexcept {
  if (std::abs(y_mm) >= half_width_ || std::abs(z_mm) >= half_height_) return 0;
  double sum = 0;
  for (int i = 2 * terms_ - 1; i > 0; i -= 2) {
    const double k = i * kPi / (2 * half_width_);
    const double z = std::abs(z_mm);
    // cosh(k z) / cosh(k b)
    const double ratio =
        std::exp(k * (z - half_height_)) * (1 + std::exp(-2 * k * z)) / (1 + std::exp(-2 * k * half_height_));
    const double sign = (i / 2) % 2 == 0 ? 1 : -1;
    sum += sign * (1 - ratio) * std::cos(k * y_mm) / (static_cast<double>(i) * i * i);
  }
  return scale_ * sum;
}

double DuctFlow::fastest_mm_s() const noexcept { return std::abs(velocity_mm_s(0, 0)); }

}  // namespace rptv
