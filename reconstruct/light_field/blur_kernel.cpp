// SPDX-License-Identifier: MIT
// Numerical integration of sinc² over pixels.
#include "reconstruct/light_field/blur_kernel.hpp"

#include <cmath>
#include <numbers>

namespace rptv {

namespace {

constexpr double kNegligible = 0.025;

double sinc_squared(double t) noexcept {
  const double angle = std::numbers::pi * t;
  return std::abs(angle) < 1e-6 ? 1 : std::pow(std::sin(angle) / angle, 2);
}

/// Share of the light of a point that lies between `from` and `to`, in units of the first zero.
double share_between(double from, double to) noexcept {
  constexpr int kStepsPerUnit = 400;
  const int steps = 2 * static_cast<int>(std::ceil((to - from) * kStepsPerUnit)) + 2;  // even: Simpson
  const double h = (to - from) / steps;
  double sum = sinc_squared(from) + sinc_squared(to);
  for (int i = 1; i < steps; ++i) sum += (i % 2 == 1 ? 4 : 2) * sinc_squared(from + i * h);
  return sum * h / 3;
}

}  // namespace

std::vector<float> diffraction_filter(double first_zero_um, double pixel_um, std::size_t longest) {
  if (!(first_zero_um > 0)) return {1.0F};
  const double pixel = pixel_um / first_zero_um;
  std::vector<float> filter;
  double rest = 1;  // of the light, not yet in the filter
  for (std::size_t i = 0; i <= longest && (i == 0 || rest > 2 * kNegligible); ++i) {
    const double centre = static_cast<double>(i) * pixel;
    const double share = share_between(centre - pixel / 2, centre + pixel / 2);
    filter.push_back(static_cast<float>(share));
    rest -= i == 0 ? share : 2 * share;
  }
  return filter;
}

}  // namespace rptv
