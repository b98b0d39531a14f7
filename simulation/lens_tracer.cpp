// SPDX-License-Identifier: MIT
// Intersection with conics and refraction in vector form (Welford 1986, chapter 4).
#include "simulation/lens_tracer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rptv {

LensTracer::LensTracer(const Prescription& lens, double stop_radius_mm, std::span<const Rim> rims) {
  constexpr double kNoRim = std::numeric_limits<double>::infinity();
  double z = 0, before = 1;
  stop_ = lens.stop;
  stop_radius_ = stop_radius_mm > 0 ? stop_radius_mm : lens.surfaces[lens.stop].clear_radius_mm;
  for (std::size_t i = 0; i < lens.surfaces.size(); ++i) {
    const LensSurface& surface = lens.surfaces[i];
    const double clear = i == lens.stop ? stop_radius_ : surface.clear_radius_mm;
    elements_.push_back(
        {z, surface.curvature(), surface.conic, clear > 0 ? clear * clear : kNoRim, before, surface.index_after});
    before = surface.index_after;
    z += surface.thickness_mm;
  }
  for (const Rim& rim : rims) {
    const auto behind =
        std::find_if(elements_.begin(), elements_.end(), [&](const Element& e) { return e.z > rim.z_mm; });
    const double index = behind == elements_.end() ? elements_.back().after : behind->before;
    const auto place = static_cast<std::size_t>(behind - elements_.begin());
    elements_.insert(behind, {rim.z_mm, 0, 0, rim.radius_mm * rim.radius_mm, index, index});
    if (place <= stop_) ++stop_;
  }
}

/// Moves the ray to the surface, the sheet that holds the vertex: c (x^2 + y^2 + (1+k) z^2) = 2 z.
bool LensTracer::meet(const Element& element, LensRay& ray) noexcept {
  const double z = ray.z - element.z, c = element.curvature, k1 = 1 + element.conic;
  double length;
  if (c == 0) {
    length = -z / ray.n;
  } else {
    const double a = c * (1 + element.conic * ray.n * ray.n);
    const double b = ray.n - c * (ray.x * ray.l + ray.y * ray.m + k1 * z * ray.n);
    const double e = c * (ray.x * ray.x + ray.y * ray.y + k1 * z * z) - 2 * z;
    const double root = b * b - a * e;
    if (!(root >= 0)) return false;
    length = e / (b + std::copysign(std::sqrt(root), ray.n));
  }
  ray.x += length * ray.l;
  ray.y += length * ray.m;
  ray.z += length * ray.n;
  return ray.x * ray.x + ray.y * ray.y <= element.rim2;
}

/// Snell's law, d' = r d + (r cos i - cos t) N; `ratio` r is index before over index behind.
bool LensTracer::refract(const Element& element, LensRay& ray, double ratio) noexcept {
  const double c = element.curvature;
  double nx = c * ray.x, ny = c * ray.y, nz = c * (1 + element.conic) * (ray.z - element.z) - 1;
  if (element.conic != 0) {
    const double scale = 1 / std::sqrt(nx * nx + ny * ny + nz * nz);
    nx *= scale, ny *= scale, nz *= scale;
  }
  const double cosine = -(ray.l * nx + ray.m * ny + ray.n * nz);  // negative when the normal runs with the ray
  const double inside = 1 - ratio * ratio * (1 - cosine * cosine);
  if (!(inside >= 0)) return false;
  const double along = ratio * cosine - std::copysign(std::sqrt(inside), cosine);
  ray.l = ratio * ray.l + along * nx;
  ray.m = ratio * ray.m + along * ny;
  ray.n = ratio * ray.n + along * nz;
  return true;
}

bool LensTracer::forward(LensRay& ray) const noexcept {
  for (const Element& element : elements_) {
    if (!meet(element, ray)) return false;
    if (element.before != element.after && !refract(element, ray, element.before / element.after)) return false;
  }
  return true;
}

bool LensTracer::backward(LensRay& ray) const noexcept {
  for (auto element = elements_.rbegin(); element != elements_.rend(); ++element) {
    if (!meet(*element, ray)) return false;
    if (element->before != element->after && !refract(*element, ray, element->after / element->before)) return false;
  }
  return true;
}

double LensTracer::height_at_stop(LensRay ray) const noexcept {
  const bool ahead = ray.n > 0;
  for (std::size_t i = ahead ? 0 : elements_.size() - 1; i != stop_; ahead ? ++i : --i) {
    const Element& element = elements_[i];
    const double ratio = ahead ? element.before / element.after : element.after / element.before;
    if (!meet(element, ray) || !refract(element, ray, ratio)) return -1;
  }
  Element open = elements_[stop_];
  open.rim2 = std::numeric_limits<double>::infinity();
  return meet(open, ray) ? std::hypot(ray.x, ray.y) : -1;
}

}  // namespace rptv
