// SPDX-License-Identifier: MIT
// Chooses the coordinate of a pencil of epipolar lines, and sorts detections by it.
#include "reconstruct/multi_view/epipolar_pencil.hpp"

namespace rptv {

namespace {

Point3 project(const Projection& pinhole, const Point3& at) noexcept {
  Point3 image;
  for (std::size_t r = 0; r < 3; ++r)
    image[r] = pinhole[r][0] * at[0] + pinhole[r][1] * at[1] + pinhole[r][2] * at[2] + pinhole[r][3];
  return image;
}

}  // namespace

// `along` is at right angles to `across`, and 1 in the middle of the image; for parallel lines it is 1 everywhere.
PencilOfLines::PencilOfLines(const ViewRays& first, const ViewRays& second) noexcept {
  constexpr double kNearest = 0.1;  // of `along` in the image
  const Point3 epipole = project(second.pinhole(), first.pinhole_centre_mm());
  const auto& [left, top, right, bottom] = second.pinhole_range();
  const Point3 middle{(left + right) / 2, (top + bottom) / 2, 1};
  across = cross(epipole, middle);
  across = (1 / std::hypot(across[0], across[1])) * across;
  along = {across[1] * epipole[2], -across[0] * epipole[2], across[0] * epipole[1] - across[1] * epipole[0]};
  along = (1 / dot(along, middle)) * along;
  least = HUGE_VAL, most = -HUGE_VAL;
  usable = true;
  for (const double u : {left, right})
    for (const double v : {top, bottom}) {
      const double coordinate = of({u, v, 1});
      usable = usable && dot(along, Point3{u, v, 1}) > kNearest && std::isfinite(coordinate);
      least = std::min(least, coordinate), most = std::max(most, coordinate);
    }
}

void EpipolarPencil::build(const PencilOfLines& lines, const SeenView& view) noexcept {
  lines_ = &lines;
  bins_ = PencilBins(lines, static_cast<std::uint32_t>(view.size()));
  std::fill_n(start_.begin(), bins_.bins + 1, 0U);
  for (std::size_t i = 0; i < view.size(); ++i) {
    if (!view.usable(i)) continue;
    bin_[i] = bins_.of(lines.of({view.u(i), view.v(i), 1}));
    ++start_[bin_[i]];
  }
  std::uint32_t sum = 0;
  for (std::size_t b = 0; b <= bins_.bins; ++b) start_[b] = sum += start_[b];
  for (std::size_t i = view.size(); i-- > 0;)
    if (view.usable(i)) entry_[--start_[bin_[i]]] = {view.u(i), view.v(i), static_cast<std::uint32_t>(i)};
}

}  // namespace rptv
