// SPDX-License-Identifier: MIT
// Scans rows for maxima, and fits parabolas to logarithms.
#include "reconstruct/multi_view/residual_peaks.hpp"

#include <algorithm>
#include <cmath>

namespace rptv {

namespace {

constexpr float kPixelVariance = 1.0F / 12;  // of a square pixel, px²

/// visit(column, row, pixel in the middle of three rows) for every maximum that is bright enough.
template <class Visit>
void visit_maxima(const ResidualView& view, const PeakOptions& options, const Visit& visit) noexcept {
  const float square_sigmas = options.threshold_sigmas * options.threshold_sigmas;
  for (int y = 0; y < view.height_px(); ++y) {
    const float *above = view.residual_row(y - 1), *row = view.residual_row(y), *below = view.residual_row(y + 1);
    const float* weight = view.weight_row(y);
    for (int x = 0; x < view.width_px(); ++x) {
      const float top = row[x];
      if (!(top > options.threshold)) continue;
      if (top < row[x + 1] || top <= row[x - 1] || top < below[x] || top <= above[x]) continue;
      if (top < below[x - 1] || top < below[x + 1] || top <= above[x - 1] || top <= above[x + 1]) continue;
      if (weight[x] > 0 && top * top * weight[x] < square_sigmas) continue;
      visit(x, y, above + x, row + x, below + x);
    }
  }
}

float shift_px(float before, float top, float after, float variance_px2) noexcept {
  const float least = 0.02F * top;
  const float shift = 0.5F * variance_px2 * std::log(std::max(after, least) / std::max(before, least));
  return std::clamp(shift, -0.6F, 0.6F);
}

float middle_share(float shift, float sigma_px) noexcept {
  const float per = 0.70710678F / sigma_px;
  return 0.5F * (std::erf((0.5F - shift) * per) + std::erf((0.5F + shift) * per));
}

}  // namespace

void find_peaks(const ResidualView& view, const PeakOptions& options, float sigma_px, Detections& out) noexcept {
  out.clear();
  const float variance = sigma_px * sigma_px + kPixelVariance;
  visit_maxima(view, options, [&](int x, int y, const float* above, const float* middle, const float* below) {
    const float dx = shift_px(middle[-1], *middle, middle[1], variance);
    const float dy = shift_px(*above, *middle, *below, variance);
    Detection peak;
    peak.x_px = static_cast<double>(static_cast<float>(x) + dx);
    peak.y_px = static_cast<double>(static_cast<float>(y) + dy);
    peak.sigma_px = 0.3;
    peak.grey = static_cast<double>(*middle / (middle_share(dx, sigma_px) * middle_share(dy, sigma_px)));
    peak.area_px = 1;
    out.push(peak);
  });
}

float typical_sigma_px(const ResidualView& view, const PeakOptions& options, std::span<float> scratch,
                       float otherwise) noexcept {
  std::size_t count = 0;
  visit_maxima(view, options, [&](int, int, const float* above, const float* middle, const float* below) {
    if (count == scratch.size() || std::min({middle[-1], middle[1], *above, *below}) <= 0) return;
    const float curvature =
        4 * std::log(*middle) - std::log(middle[-1]) - std::log(middle[1]) - std::log(*above) - std::log(*below);
    if (curvature > 0) scratch[count++] = 2 / curvature;
  });
  if (count < 10) return otherwise;
  const auto half = scratch.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(scratch.begin(), half, scratch.begin() + static_cast<std::ptrdiff_t>(count));
  return std::sqrt(std::max(*half - kPixelVariance, 0.04F));
}

}  // namespace rptv
