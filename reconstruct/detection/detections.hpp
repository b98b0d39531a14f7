// SPDX-License-Identifier: MIT
// The particle images found in one frame of one camera, as a structure of arrays of fixed capacity.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace rptv {

/// One particle image, for passing by value. Pixel centres are integers, x is the column and y the row.
struct Detection {
  double x_px = 0, y_px = 0;
  double sigma_px = 0;   ///< standard error of x_px and of y_px, each
  double grey = 0;       ///< light: sum of grey values over the background
  double area_px = 0;    ///< pixels that it covers
  double angle_rad = 0;  ///< of the long axis, from x towards y, -π/2 … π/2; blobs only, otherwise 0
  double long_px = 0;    ///< rms half-length along the long axis; blobs only, otherwise 0
  double short_px = 0;   ///< rms half-length across it; blobs only, otherwise 0
};

/// Arrays of equal length size(). All memory is taken by the constructor; push() never allocates. One thread at a time.
class Detections {
 public:
  /// Capacity in detections; throws std::bad_alloc.
  explicit Detections(std::size_t capacity = 0) : capacity_(capacity) {
    for (auto* column : columns()) column->reserve(capacity);
  }
  Detections(const Detections&) = delete;  // a copied vector has no reserve
  Detections& operator=(const Detections&) = delete;
  Detections(Detections&&) = default;
  Detections& operator=(Detections&&) = default;

  std::size_t size() const noexcept { return x_px.size(); }
  std::size_t capacity() const noexcept { return capacity_; }
  std::uint64_t overflow() const noexcept { return overflow_; }  ///< detections refused since clear()

  void clear() noexcept {
    for (auto* column : columns()) column->clear();
    overflow_ = 0;
  }
  /// False, and counted, when full.
  bool push(const Detection& d) noexcept {
    if (size() == capacity_) {
      ++overflow_;
      return false;
    }
    x_px.push_back(d.x_px), y_px.push_back(d.y_px), sigma_px.push_back(d.sigma_px);
    grey.push_back(d.grey), area_px.push_back(d.area_px);
    angle_rad.push_back(d.angle_rad), long_px.push_back(d.long_px), short_px.push_back(d.short_px);
    return true;
  }
  /// Counts detections that a stage found beyond capacity() without making them.
  void refuse(std::uint64_t count) noexcept { overflow_ += count; }

  std::vector<double> x_px, y_px, sigma_px, grey, area_px, angle_rad, long_px, short_px;

 private:
  std::array<std::vector<double>*, 8> columns() noexcept {
    return {&x_px, &y_px, &sigma_px, &grey, &area_px, &angle_rad, &long_px, &short_px};
  }
  std::size_t capacity_ = 0;
  std::uint64_t overflow_ = 0;
};

}  // namespace rptv
