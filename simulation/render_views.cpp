// SPDX-License-Identifier: MIT
// Gaussians integrated over pixels, added up, and exposed.
#include "simulation/render_views.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace rptv {

namespace {

constexpr std::uint64_t kViewStream = std::uint64_t{7} << 56;
constexpr int kCameraShift = 48;    // frames below, cameras above
constexpr double kReachSigmas = 5;  // 6e-7 of the light is beyond
constexpr double kInViewSigmas = 3;
constexpr std::size_t kMostTaps = 128;

/// The Gaussian's share of each pixel of one axis, from `first` on.
struct Shares {
  int first = 0, count = 0;
  std::array<float, kMostTaps> share;

  Shares(double centre, double sigma, int size) noexcept {
    const int low = std::max(0, static_cast<int>(std::floor(centre - kReachSigmas * sigma)));
    const int high = std::min(size - 1, static_cast<int>(std::ceil(centre + kReachSigmas * sigma)));
    first = low, count = std::clamp(high - low + 1, 0, static_cast<int>(kMostTaps));
    const double scale = 1 / (std::numbers::sqrt2 * sigma);
    double left = std::erf((low - 0.5 - centre) * scale);
    for (int i = 0; i < count; ++i) {
      const double right = std::erf((low + i + 0.5 - centre) * scale);
      share[static_cast<std::size_t>(i)] = static_cast<float>(0.5 * (right - left));
      left = right;
    }
  }
};

ScenarioSettings with_sensor(ScenarioSettings scenario, const CameraModel& model) {
  scenario.camera.width_px = model.intrinsics().width_px, scenario.camera.height_px = model.intrinsics().height_px;
  return scenario;
}

}  // namespace

ViewRenderer::ViewRenderer(const ScenarioSettings& scenario, const CameraModel& model, std::uint64_t camera)
    : photoelectrons_(scenario.seeding.photoelectrons),
      sigma_px_(scenario.views.sigma_px),
      model_(model),
      stream_(kViewStream | camera << kCameraShift),
      exposure_(with_sensor(scenario, model)),
      expected_(exposure_.shape().pixels()) {}

ViewOfTracer ViewRenderer::view_of(const Tracer& tracer) const noexcept {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const double margin = kInViewSigmas * sigma_px_;
  const Pixel at =
      model_.project({tracer.position.x, tracer.position.y, tracer.position.z}).value_or(Pixel{kNan, kNan});
  return {at, at[0] >= margin && at[1] >= margin && at[0] <= shape().width_px - 1 - margin &&
                  at[1] <= shape().height_px - 1 - margin};
}

void ViewRenderer::add_image(const Pixel& at) noexcept {
  const int width = static_cast<int>(shape().width_px), height = static_cast<int>(shape().height_px);
  const double reach = kReachSigmas * sigma_px_ + 1;
  if (!(at[0] > -reach && at[1] > -reach && at[0] < width + reach && at[1] < height + reach)) return;
  const Shares across(at[0], sigma_px_, width), down(at[1], sigma_px_, height);
  for (int j = 0; j < down.count; ++j) {
    const float light = static_cast<float>(photoelectrons_) * down.share[static_cast<std::size_t>(j)];
    float* row = expected_.data() + static_cast<std::ptrdiff_t>(down.first + j) * width + across.first;
    for (int i = 0; i < across.count; ++i) row[i] += light * across.share[static_cast<std::size_t>(i)];
  }
}

void ViewRenderer::render(std::span<const Tracer> tracers, std::uint64_t frame, std::span<std::byte> pixels) {
  std::fill(expected_.begin(), expected_.end(), 0.0F);
  views_.clear();
  for (const Tracer& tracer : tracers) {
    views_.push_back(view_of(tracer));
    add_image(views_.back().pixel);
  }
  exposure_.expose(expected_, stream_ | frame, pixels);
}

}  // namespace rptv
