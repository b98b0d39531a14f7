// SPDX-License-Identifier: MIT
// Fisher information pixel by pixel, then one dense inverse.
#include "reconstruct/light_field/cramer_rao.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

namespace rptv {

namespace {

constexpr std::size_t kMostPixels = 1 << 18;  // of one particle's image
constexpr double kRidge = 1e-12;              // of the scaled matrix: a particle without depth stays invertible

/// What one particle does to one pixel.
struct Touch {
  std::uint32_t pixel, particle;
  Eigen::Vector4f gradient;  // with respect to x, y, z, light
  float grey;
};

std::vector<Touch> touches_of(ImageModel& model, std::span<const BrightPoint> particles) {
  std::vector<Touch> all;
  ParticleImage image(kMostPixels);
  for (std::uint32_t k = 0; k < particles.size(); ++k) {
    if (!model.render(particles[k].at, image)) continue;
    const auto light = static_cast<float>(particles[k].light);
    for (std::size_t i = 0; i < image.size; ++i)
      all.push_back({image.pixel[i],
                     k,
                     {light * image.dx[i], light * image.dy[i], light * image.dz[i], image.value[i]},
                     light * image.value[i]});
  }
  std::sort(all.begin(), all.end(), [](const Touch& a, const Touch& b) { return a.pixel < b.pixel; });
  return all;
}

// The pixels are independent of each other; all who touch one share its information.
Eigen::MatrixXd information_of(std::span<const Touch> touches, std::size_t particles, const PixelNoise& noise) {
  const auto size = static_cast<Eigen::Index>(4 * particles);
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(size, size);
  for (std::size_t first = 0, last = 0; first < touches.size(); first = last) {
    double grey = 0;
    for (; last < touches.size() && touches[last].pixel == touches[first].pixel; ++last)
      grey += static_cast<double>(touches[last].grey);
    const double weight = 1 / (noise.dark_variance + noise.variance_per_grey * std::max(grey, 0.0));
    for (std::size_t i = first; i < last; ++i)
      for (std::size_t j = first; j < last; ++j)
        information.block<4, 4>(4 * touches[i].particle, 4 * touches[j].particle) +=
            weight * (touches[i].gradient * touches[j].gradient.transpose()).cast<double>();
  }
  return information;
}

}  // namespace

std::vector<FitCovariance> cramer_rao_bounds(ImageModel& model, std::span<const BrightPoint> particles,
                                             const PixelNoise& noise) {
  const std::vector<Touch> touches = touches_of(model, particles);
  Eigen::MatrixXd information = information_of(touches, particles.size(), noise);
  Eigen::VectorXd scale = information.diagonal();  // to a unit diagonal: lengths and lights differ by many orders
  for (double& s : scale) s = s > 0 ? 1 / std::sqrt(s) : 0;
  information = scale.asDiagonal() * information * scale.asDiagonal();
  information.diagonal().array() += kRidge;
  const Eigen::MatrixXd inverse = information.llt().solve(Eigen::MatrixXd(scale.asDiagonal()));
  std::vector<FitCovariance> bounds;
  constexpr double kUnknown = std::numeric_limits<double>::infinity();
  for (Eigen::Index k = 0; k < static_cast<Eigen::Index>(particles.size()); ++k) {
    const auto at = [&](int row, int column) { return scale[4 * k + row] * inverse(4 * k + row, 4 * k + column); };
    const bool seen = scale[4 * k + 3] > 0;
    bounds.push_back(seen ? FitCovariance{at(0, 0), at(0, 1), at(0, 2), at(1, 1), at(1, 2), at(2, 2)}
                          : FitCovariance{kUnknown, 0, 0, kUnknown, 0, kUnknown});
  }
  return bounds;
}

}  // namespace rptv
