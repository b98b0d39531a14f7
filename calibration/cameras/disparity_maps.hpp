// SPDX-License-Identifier: MIT
// A disparity map for each camera in each part of the volume, and what they say of the cameras together.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "calibration/cameras/disparity_map.hpp"
#include "calibration/space.hpp"

namespace rptv {

/// A box of the rig's frame (mm) cut into parts[0] × parts[1] × parts[2] equal ones along x, y, z.
struct DisparityGrid {
  Point3 from_mm{}, to_mm{};
  std::array<std::size_t, 3> parts{4, 3, 2};

  std::size_t size() const noexcept { return parts[0] * parts[1] * parts[2]; }
  /// Number of the part that a point is in, x fastest; none outside of the box.
  std::optional<std::size_t> part_of(const Point3& point_mm) const noexcept;
  Point3 centre_mm(std::size_t part) const noexcept;
};

/// What the maps of one camera say. Lengths of disparities, px.
struct CameraDisparity {
  std::size_t parts = 0;  ///< that have a peak
  double votes = 0;       ///< of the peaks
  double median_px = 0;   ///< over these parts; infinite without any
  double worst_px = 0;    ///< of the part with the largest one
  Point3 worst_at_mm{};   ///< where that part's particles are, on average
};

/// Memory is fixed by the constructor: 9.6 kB for each camera and part. add() is plain arithmetic without allocation;
/// the others allocate. One thread at a time.
class DisparityMaps {
 public:
  /// Throws Error(usage) for a box without volume, no parts, or more than kMostParts.
  static constexpr std::size_t kMostParts = 4096;
  DisparityMaps(const DisparityGrid& grid, std::size_t cameras, double radius_px);

  /// `position_mm`: the triangulated particle, rig's frame; `disparity_px`: its projection less its detection. Counted
  /// as outside() when the particle is outside of the grid or the disparity beyond the map.
  void add(std::size_t camera, const Point3& position_mm, const Pixel& disparity_px) noexcept;
  /// Older votes fade by `factor`, 0 to 1.
  void fade(double factor) noexcept;

  std::optional<DisparityPeak> peak(std::size_t camera, std::size_t part) const;
  /// Mean of the positions that voted, all cameras; the part's centre when there are none.
  Point3 middle_mm(std::size_t part) const noexcept;
  CameraDisparity summary(std::size_t camera) const;

  const DisparityGrid& grid() const noexcept { return grid_; }
  std::size_t cameras() const noexcept { return cameras_; }
  double radius_px() const noexcept { return maps_.front().radius_px(); }
  double outside() const noexcept;

 private:
  DisparityGrid grid_;
  std::size_t cameras_;
  std::vector<DisparityMap> maps_;                ///< [part · cameras + camera]
  std::vector<std::array<double, 4>> positions_;  ///< of each part: sums of x, y, z and how many
  double outside_ = 0;
};

}  // namespace rptv
