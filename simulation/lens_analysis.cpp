// SPDX-License-Identifier: MIT
// Ray transfer of (height, index times slope) from surface to surface.
#include "simulation/lens_analysis.hpp"

#include <fmt/format.h>

#include <cmath>
#include <vector>

namespace rptv {

namespace {

/// Transfer of (y, n u) from just before surface `first` to just behind surface `last` - 1; identity when empty.
struct Transfer {
  double a = 1, b = 0, c = 0, d = 1;  ///< y' = a y + b nu, nu' = c y + d nu

  void refract(double power) {
    c -= power * a;
    d -= power * b;
  }
  void travel(double reduced_mm) {
    a += reduced_mm * c;
    b += reduced_mm * d;
  }
};

double index_before(const Prescription& lens, std::size_t surface) {
  return surface == 0 ? 1.0 : lens.surfaces[surface - 1].index_after;
}

/// From surface `first` up to, and not with, surface `last`; ends behind surface last - 1, without the gap behind it.
Transfer transfer(const Prescription& lens, std::size_t first, std::size_t last) {
  Transfer matrix;
  for (std::size_t i = first; i < last; ++i) {
    const LensSurface& surface = lens.surfaces[i];
    matrix.refract((surface.index_after - index_before(lens, i)) * surface.curvature());
    if (i + 1 < last) matrix.travel(surface.thickness_mm / surface.index_after);
  }
  return matrix;
}

/// From the first vertex to the plane of the stop, without what the stop's own surface does.
StopMap map_to_stop(const Prescription& lens) {
  if (lens.stop == 0) return {};
  Transfer matrix = transfer(lens, 0, lens.stop);
  const LensSurface& before = lens.surfaces[lens.stop - 1];
  matrix.travel(before.thickness_mm / before.index_after);
  return {matrix.a, matrix.b};
}

}  // namespace

double lens_power(const Prescription& lens) { return -transfer(lens, 0, lens.surfaces.size()).c; }

LensAnalysis analyse(const Prescription& lens, double stop_radius_mm) {
  LensAnalysis out;
  const std::size_t count = lens.surfaces.size();
  const Transfer whole = transfer(lens, 0, count);
  out.length_mm = lens.vertex_z_mm(count - 1);
  out.efl_mm = -1 / whole.c;
  out.f2_z_mm = out.length_mm - whole.a / whole.c;
  out.h2_z_mm = out.f2_z_mm - out.efl_mm;
  out.f1_z_mm = whole.d / whole.c;
  out.h1_z_mm = out.f1_z_mm + out.efl_mm;
  out.stop_z_mm = lens.vertex_z_mm(lens.stop);
  out.stop_radius_mm = stop_radius_mm > 0 ? stop_radius_mm : lens.surfaces[lens.stop].clear_radius_mm;
  out.from_object = map_to_stop(lens);
  out.from_image = map_to_stop(lens.reversed());
  // The pupil is where all rays of one height at the stop meet: y at distance slope/height before the vertex.
  out.entrance_pupil_z_mm = out.from_object.slope / out.from_object.height;
  out.entrance_pupil_radius_mm = out.stop_radius_mm / std::abs(out.from_object.height);
  out.exit_pupil_z_mm = out.length_mm - out.from_image.slope / out.from_image.height;
  out.exit_pupil_radius_mm = out.stop_radius_mm / std::abs(out.from_image.height);
  return out;
}

LensConjugates conjugates_of_object(const LensAnalysis& lens, double object_mm) {
  return {object_mm, 1 / (1 / lens.efl_mm - 1 / object_mm)};
}

LensConjugates conjugates_of_magnification(const LensAnalysis& lens, double magnification) {
  return {lens.efl_mm * (1 + 1 / magnification), lens.efl_mm * (1 + magnification)};
}

std::string describe_lens(const Prescription& lens, double stop_radius_mm, double magnification) {
  const LensAnalysis figures = analyse(lens, stop_radius_mm);
  std::string text = fmt::format("{}\n  source: {}\n", lens.name, lens.source);
  if (!lens.note.empty()) text += fmt::format("  note: {}\n", lens.note);
  text += fmt::format(
      "  {} surfaces, {:.4f} mm from first to last vertex, stop at surface {} (z {:.4f} mm, radius {:.4f} mm)\n"
      "  EFL {:.4f} mm, f/{:.3f}\n"
      "  focal points F1 z {:.4f}, F2 z {:.4f} mm; principal planes H1 z {:.4f}, H2 z {:.4f} mm (apart {:.4f})\n"
      "  entrance pupil z {:.4f}, radius {:.4f} mm; exit pupil z {:.4f}, radius {:.4f} mm\n",
      lens.surfaces.size(), figures.length_mm, lens.stop + 1, figures.stop_z_mm, figures.stop_radius_mm, figures.efl_mm,
      figures.f_number(), figures.f1_z_mm, figures.f2_z_mm, figures.h1_z_mm, figures.h2_z_mm,
      figures.h2_z_mm - figures.h1_z_mm, figures.entrance_pupil_z_mm, figures.entrance_pupil_radius_mm,
      figures.exit_pupil_z_mm, figures.exit_pupil_radius_mm);
  for (const double m : magnification > 0 ? std::vector<double>{magnification} : std::vector<double>{1.0, 2.5}) {
    const LensConjugates plane = conjugates_of_magnification(figures, m);
    const double to_pupil = figures.h2_z_mm + plane.image_mm - figures.exit_pupil_z_mm;
    text += fmt::format(
        "  at {:.3g}:1: object {:.4f} mm before H1 ({:.3f} mm before the first vertex), image {:.4f} mm behind H2, "
        "{:.4f} mm behind the exit pupil, cone f/{:.3f}\n",
        m, plane.object_mm, plane.object_mm - figures.h1_z_mm, plane.image_mm, to_pupil,
        to_pupil / (2 * figures.exit_pupil_radius_mm));
  }
  return text;
}

}  // namespace rptv
