// SPDX-License-Identifier: MIT
// Parallel plane interfaces between camera and particles (air, glass, liquid) and the path of light through them.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "calibration/space.hpp"

namespace rptv {

/// What light passes through.
struct Medium {
  double index = 1;  ///< refractive index
};

/// A plane n·P = position_mm, n being the stack's normal, and what lies behind it as the camera sees it.
struct Interface {
  double position_mm = 0;
  Medium behind;
};

/// The walls of a tank in the rig's frame. Particles are in the medium behind the last interface.
struct RefractiveStack {
  Point3 normal{0, 0, 1};             ///< unit vector across all interfaces, towards the camera
  Medium before;                      ///< where the camera is
  std::vector<Interface> interfaces;  ///< nearest the camera first; empty: no refraction
};

/// Direction in which a camera sees a point, up to a positive factor, and its derivative by the point.
struct SeenDirection {
  Point3 direction;    ///< in the rig's frame, in the camera's medium; the component along the normal is -1 or P - C
  Matrix3 derivative;  ///< d(direction)/d(point), 1/mm or 1
};

/// What light a camera sees, behind the last interface: unit direction, away from the camera, in the rig's frame.
struct SightRay {
  Point3 origin_mm, direction;
  /// False (and the numbers are NaN) for a pixel that no light reaches: beyond the fold of the distortion, past the
  /// interfaces, or totally reflected.
  bool valid() const noexcept { return direction[0] == direction[0]; }
};

/// Light between one camera's centre of projection and points behind the stack. Immutable, allocates nothing after
/// construction, any thread.
class RefractedPath {
 public:
  static constexpr std::size_t kMostInterfaces = 8;

  /// Throws Error(configuration): normal not of unit length, interfaces out of order or in front of the camera, index
  /// not within 1 to 4, too many. `origin` stands before the message.
  RefractedPath(const Point3& centre_mm, const RefractiveStack& stack, const std::string& origin);

  /// Towards `point`, in any of the media. Snell's law leaves one unknown in the plane of incidence; Newton finds it to
  /// the last digits. None where the iteration fails (a point at no distance, or not finite).
  std::optional<Point3> direction_to(const Point3& point) const noexcept;
  std::optional<SeenDirection> derivative_to(const Point3& point) const noexcept;

  /// The ray in the last medium of light that leaves the camera along a unit `direction`. None when it does not reach
  /// the interfaces or is totally reflected.
  std::optional<SightRay> follow(const Point3& direction) const noexcept;

  const Point3& centre_mm() const noexcept { return centre_mm_; }

 private:
  struct Solution;
  bool solve(const Point3& point, Solution& solution) const noexcept;

  Point3 centre_mm_, normal_;
  std::size_t media_;                                    ///< interfaces + 1
  std::array<double, kMostInterfaces + 1> index_{};      ///< of each medium, the camera's first
  std::array<double, kMostInterfaces + 1> thickness_{};  ///< along the normal, mm; the last one's is the point's affair
  std::array<double, kMostInterfaces + 1> depth_{};      ///< where each medium begins, from the camera, mm
};

}  // namespace rptv
