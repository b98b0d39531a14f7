// SPDX-License-Identifier: MIT
// Exact sequential ray trace through a prescription: conic surfaces, Snell's law, stop and rims.
#pragma once

#include <span>
#include <vector>

#include "simulation/prescription.hpp"
#include "simulation/surface_kernel.hpp"

namespace rptv {

/// A ray in the lens frame: a point, mm, and a unit direction.
struct LensRay {
  double x = 0, y = 0, z = 0;
  double l = 0, m = 0, n = 1;
};

/// A thin screen with a round hole on the axis: a mount, a hood, a filter ring.
struct Rim {
  double z_mm = 0;  ///< lens frame
  double radius_mm = 0;
};

/// Rays from the object to the image side and back. Immutable; any thread.
class LensTracer {
 public:
  /// `stop_radius_mm` 0 leaves the stop as wide as the prescription has it; `rims` are added in their place by z.
  LensTracer(const Prescription& lens, double stop_radius_mm, std::span<const Rim> rims);

  /// Carries a ray with positive n through the lens: afterwards it starts on the last surface or rim. False when it is
  /// lost: it misses a surface, hits a rim or is totally reflected.
  bool forward(LensRay& ray) const noexcept;
  /// The same against the light, for rays with negative n.
  bool backward(LensRay& ray) const noexcept;
  /// Many at a time, several times faster and the same bit for bit; a ray that is lost has n = 0.
  void forward(std::span<LensRay> rays) const noexcept { pass_many(ahead_, rays); }
  void backward(std::span<LensRay> rays) const noexcept { pass_many(back_, rays); }
  /// Distance from the axis at which the ray crosses the stop, whatever the stop's radius, or -1 when the ray is lost
  /// before; other rims count.
  double height_at_stop(LensRay ray) const noexcept;
  double stop_radius_mm() const noexcept { return stop_radius_; }

 private:
  void pass_many(std::span<const SurfaceStep> steps, std::span<LensRay> rays) const noexcept;
  bool pass_one(std::span<const SurfaceStep> steps, LensRay& ray) const noexcept;

  std::vector<SurfaceStep> ahead_, back_;  ///< in the order of the light, and against it
  std::size_t stop_ = 0;                   ///< among ahead_
  double stop_radius_ = 0;
};

}  // namespace rptv
