// SPDX-License-Identifier: MIT
// Fully developed laminar flow in a rectangular duct.
#pragma once

#include "simulation/flow.hpp"

namespace rptv {

/// u(y, z) along x in |y| <= width/2, |z| <= height/2: Boussinesq's series (White, Viscous Fluid Flow, eq. 3-48),
/// scaled so that the flow rate is the scenario's. Zero on the walls and outside.
class DuctFlow : public Flow {
 public:
  /// `terms` of the series: odd orders 1, 3, … The default leaves less than 1e-5 of the mean velocity.
  explicit DuctFlow(const DuctSettings& duct, int terms = 60);

  double velocity_mm_s(double y_mm, double z_mm) const noexcept;
  double mean_mm_s() const noexcept { return mean_; }

  Vector3 position(const Vector3& rest, double time_s) const noexcept override {
    return {rest.x + velocity_mm_s(rest.y, rest.z) * time_s, rest.y, rest.z};
  }
  Vector3 velocity(const Vector3& rest, double) const noexcept override { return drift(rest); }
  Vector3 drift(const Vector3& rest) const noexcept override { return {velocity_mm_s(rest.y, rest.z), 0, 0}; }
  Vector3 largest_drift() const noexcept override { return {velocity_mm_s(0, 0), 0, 0}; }
  double fastest_mm_s() const noexcept override;

 private:
  double half_width_, half_height_, mean_, scale_;
  int terms_;
};

}  // namespace rptv
