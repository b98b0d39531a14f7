// SPDX-License-Identifier: MIT
// The polynomial of Soloff, Adrian and Liu (Meas. Sci. Technol. 8, 1997): third order in x and y, second in z.
#pragma once

#include <array>
#include <cstddef>

#include "calibration/light_field/light_field_calibration.hpp"
#include "calibration/space.hpp"

namespace rptv {

inline constexpr std::size_t kSoloffTerms = 19;
using SoloffTerms = std::array<double, kSoloffTerms>;

/// 1, x, y, z, x², xy, y², xz, yz, z², x³, x²y, xy², y³, x²z, xyz, y²z, xz², yz²; and their derivatives along `axis`.
SoloffTerms soloff_terms(const Point3& p) noexcept;
SoloffTerms soloff_slopes(const Point3& p, std::size_t axis) noexcept;

/// Three polynomials of a position in a box. mm. Immutable; any thread.
class SoloffPolynomial {
 public:
  /// `calibration` must have passed LightFieldCalibration::validate().
  explicit SoloffPolynomial(const PolynomialCalibration& calibration);

  Point3 map(const Point3& at) const noexcept;
  /// d(map)/d(at).
  Matrix3 jacobian(const Point3& at) const noexcept;
  /// Newton from the middle of the box; for points that come from the box or near it.
  Point3 inverse(const Point3& mapped) const noexcept;

 private:
  Point3 scaled(const Point3& at) const noexcept;

  Point3 middle_{}, half_{};
  std::array<SoloffTerms, 3> factors_{};
};

}  // namespace rptv
