// SPDX-License-Identifier: MIT
// A main lens that is traced surface by surface.
#pragma once

#include "simulation/lens_analysis.hpp"
#include "simulation/lens_tracer.hpp"
#include "simulation/main_lens.hpp"

namespace rptv {

/// Rays are aimed at the paraxial image of the stop, a little wider than it is, and the stop itself decides which pass:
/// pupil aberration and vignetting are those of the real surfaces.
class PrescriptionLens : public MainLens {
 public:
  /// Throws Error(no_input, configuration).
  explicit PrescriptionLens(const ScenarioSettings& scenario);
  void trace(const Vector3& object, double body_mm, std::span<const RaySample> samples, double turn_rad,
             std::span<ArrayRay> rays) const noexcept override;
  void white(double x_mm, double y_mm, double reach_mm, std::span<const RaySample> samples,
             std::span<ArrayRay> rays) const noexcept override;

  const LensAnalysis& analysis() const noexcept { return system_.analysis; }
  double stop_radius_mm() const noexcept { return system_.analysis.stop_radius_mm; }

 private:
  struct System {
    LensAnalysis analysis;
    LensTracer tracer;
    FirstOrder figures;
  };
  explicit PrescriptionLens(System system, const ScenarioSettings& scenario);
  static System make_system(const ScenarioSettings& scenario);

  LensRay aimed(double x, double y, double z, double stop_x, double stop_y) const noexcept;
  double widening(double x, double y, double z) const noexcept;

  System system_;
  double object_z_mm_, array_z_mm_;              ///< focused plane and array, lens frame
  double object_margin_ = 1, array_margin_ = 1;  ///< how much wider than the paraxial pupil rays are aimed
};

}  // namespace rptv
