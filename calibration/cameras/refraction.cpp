// SPDX-License-Identifier: MIT
// Snell's law through parallel planes: one equation in one unknown, its derivative, and the way forward.
#include "calibration/cameras/refraction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibration/space_algebra.hpp"
#include "core/error.hpp"

namespace rptv {

namespace {
constexpr double kUnitTolerance = 1e-6;
constexpr int kMostSteps = 60;

void check(const Point3& centre_mm, const RefractiveStack& stack, const std::string& origin) {
  const auto refuse = [&](const std::string& text) { throw Error(ExitCode::configuration, origin + ": " + text); };
  if (stack.interfaces.size() > RefractedPath::kMostInterfaces)
    refuse(fmt::format("{} interfaces are too many; give at most {}", stack.interfaces.size(),
                       RefractedPath::kMostInterfaces));
  if (!(std::abs(norm(stack.normal) - 1) < kUnitTolerance))
    refuse(
        fmt::format("the interfaces' normal has length {}; give a unit vector towards the camera", norm(stack.normal)));
  const auto check_index = [&](double index) {
    if (!(index >= 1 && index <= 4))
      refuse(fmt::format("a refractive index of {} is not within 1 to 4; mend it", index));
  };
  check_index(stack.before.index);
  double nearer = dot(stack.normal, centre_mm);
  for (const auto& interface : stack.interfaces) {
    check_index(interface.behind.index);
    if (!(interface.position_mm < nearer) || !std::isfinite(interface.position_mm))
      refuse(
          fmt::format("an interface at {} mm along the normal is not behind {} mm, where the camera or the one before "
                      "it is; list them from the camera on, with the normal towards the camera",
                      interface.position_mm, nearer));
    nearer = interface.position_mm;
  }
}
}  // namespace

RefractedPath::RefractedPath(const Point3& centre_mm, const RefractiveStack& stack, const std::string& origin)
    : centre_mm_(centre_mm), media_(stack.interfaces.size() + 1) {
  check(centre_mm, stack, origin);
  const double length = norm(stack.normal);  // what a file rounds must not bend light
  normal_ = (1 / length) * stack.normal;
  index_[0] = stack.before.index;
  for (std::size_t i = 1; i < media_; ++i) {
    index_[i] = stack.interfaces[i - 1].behind.index;
    depth_[i] = dot(normal_, centre_mm) - stack.interfaces[i - 1].position_mm / length;
    thickness_[i - 1] = depth_[i] - depth_[i - 1];
  }
}

/// The plane of incidence. With tau the tangent of the angle to the normal in the thinnest medium (index m), the
/// invariant n·sin is m·tau/sqrt(1 + tau²), and a layer of index n and thickness d shifts the light sideways by
/// d·m·tau/q(n), q(n)² = n² + (n² - m²)·tau². Their sum is concave in tau and unbounded: Newton from below converges
/// from anywhere.
struct RefractedPath::Solution {
  Point3 along;         ///< unit vector sideways from the camera to the point; zero when the point is on the normal
  double sideways = 0;  ///< its distance, mm
  double tau = 0, slope = 0;  ///< the root, and d(sideways)/d(tau), mm
  double thinnest = 1;        ///< m
  std::size_t last = 0;       ///< medium that the point is in

  double q(double index) const noexcept {
    return std::sqrt(index * index + (index * index - thinnest * thinnest) * tau * tau);
  }
  /// Tangent of the angle to the normal in a medium, and its derivative by tau.
  double tangent(double index) const noexcept { return thinnest * tau / q(index); }
  double tangent_slope(double index) const noexcept {
    const double root = q(index);
    return thinnest * index * index / (root * root * root);
  }
};

bool RefractedPath::solve(const Point3& point, Solution& s) const noexcept {
  const Point3 offset = point - centre_mm_;
  const double depth = -dot(normal_, offset);
  const Point3 sideways = offset + depth * normal_;
  s.sideways = norm(sideways);
  s.along = s.sideways > 0 ? (1 / s.sideways) * sideways : Point3{};
  while (s.last + 1 < media_ && depth > depth_[s.last + 1]) ++s.last;
  const double in_last = depth - depth_[s.last];
  if (!(in_last > 0) || !std::isfinite(s.sideways)) return false;
  s.thinnest = *std::min_element(index_.begin(), index_.begin() + static_cast<std::ptrdiff_t>(s.last) + 1);
  const auto layer = [&](std::size_t i) { return i == s.last ? in_last : thickness_[i]; };
  double paraxial = 0;
  for (std::size_t i = 0; i <= s.last; ++i) paraxial += layer(i) * s.thinnest / index_[i];
  s.tau = s.sideways / paraxial;
  s.slope = paraxial;
  for (int step = 0; step < kMostSteps; ++step) {
    double reached = 0, slope = 0;
    for (std::size_t i = 0; i <= s.last; ++i) {
      const double n2 = index_[i] * index_[i], inverse = 1 / s.q(index_[i]);
      const double share = layer(i) * s.thinnest * inverse;
      reached += share * s.tau;
      slope += share * n2 * inverse * inverse;
    }
    const double change = (s.sideways - reached) / slope;
    s.tau += change, s.slope = slope;
    if (std::abs(change) <= 1e-8 * s.tau) return true;  // quadratic: what is left is its square
  }
  return false;
}

std::optional<Point3> RefractedPath::direction_to(const Point3& point) const noexcept {
  if (media_ == 1) return point - centre_mm_;
  Solution s;
  if (-dot(normal_, point - centre_mm_) <= depth_[1]) return point - centre_mm_;
  if (!solve(point, s)) return std::nullopt;
  return s.tangent(index_[0]) * s.along - normal_;
}

std::optional<SeenDirection> RefractedPath::derivative_to(const Point3& point) const noexcept {
  if (media_ == 1 || -dot(normal_, point - centre_mm_) <= depth_[1])
    return SeenDirection{point - centre_mm_, {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};
  Solution s;
  if (!solve(point, s)) return std::nullopt;
  // direction = t(tau)·e - n with e along; sideways = f(tau, depth): d(tau) = (d(sideways) - f_depth·d(depth))/f_tau,
  // and depth falls along the normal; e turns with the sideways displacement across it.
  const double by_sideways = s.tangent_slope(index_[0]) / s.slope;
  const double by_normal = by_sideways * s.tangent(index_[s.last]);
  const double across = s.sideways > 0 ? s.tangent(index_[0]) / s.sideways : by_sideways;
  SeenDirection seen{s.tangent(index_[0]) * s.along - normal_, {}};
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 3; ++column)
      seen.derivative[row][column] =
          across * ((row == column ? 1.0 : 0.0) - normal_[row] * normal_[column]) +
          s.along[row] * ((by_sideways - across) * s.along[column] + by_normal * normal_[column]);
  return seen;
}

std::optional<SightRay> RefractedPath::follow(const Point3& direction) const noexcept {
  SightRay ray{centre_mm_, direction};
  for (std::size_t i = 0; i + 1 < media_; ++i) {
    const double descent = -dot(normal_, ray.direction);
    if (!(descent > 0)) return std::nullopt;
    ray.origin_mm = ray.origin_mm + (thickness_[i] / descent) * ray.direction;
    // Snell in vector form: the sideways part scales with the ratio of the indices, the rest has unit length left.
    const double ratio = index_[i] / index_[i + 1];
    const double cosine2 = 1 - ratio * ratio * (1 - descent * descent);
    if (!(cosine2 > 0)) return std::nullopt;
    ray.direction = ratio * ray.direction + (ratio * descent - std::sqrt(cosine2)) * normal_;
  }
  return ray;
}

}  // namespace rptv
