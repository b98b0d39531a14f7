// SPDX-License-Identifier: MIT
// What a prescription amounts to near the axis: focal length, principal planes, pupils, and its conjugates.
#pragma once

#include <string>

#include "simulation/prescription.hpp"

namespace rptv {

/// Where rays from outside cross the stop, paraxially: at `height` y + `slope` u for a ray that has height y, mm, at
/// the outermost vertex and slope u per unit length inwards.
struct StopMap {
  double height = 1, slope = 0;
};

/// First-order figures, lens frame (first vertex at z = 0, light towards +z), mm; in air on both sides, so that nodal
/// and principal points coincide.
struct LensAnalysis {
  double efl_mm = 0;
  double h1_z_mm = 0, h2_z_mm = 0;  ///< principal planes
  double f1_z_mm = 0, f2_z_mm = 0;  ///< focal points
  double length_mm = 0;             ///< first to last vertex
  double stop_z_mm = 0, stop_radius_mm = 0;
  double entrance_pupil_z_mm = 0, entrance_pupil_radius_mm = 0;
  double exit_pupil_z_mm = 0, exit_pupil_radius_mm = 0;
  StopMap from_object, from_image;

  double f_number() const noexcept { return efl_mm / (2 * entrance_pupil_radius_mm); }
};

/// An object plane and its image, eq. (8).
struct LensConjugates {
  double object_mm = 0;                                                   ///< s, in front of H1
  double image_mm = 0;                                                    ///< s', behind H2
  double magnification() const noexcept { return image_mm / object_mm; }  ///< positive for a real (inverted) image
};

/// 1/EFL, 1/mm; 0 for an afocal system.
double lens_power(const Prescription& lens);

/// Paraxial trace (ynu) of the whole lens and of both sides of the stop. `stop_radius_mm` 0: as wide as the
/// prescription has it. The prescription must have power (read_prescription() sees to it).
LensAnalysis analyse(const Prescription& lens, double stop_radius_mm = 0);

LensConjugates conjugates_of_object(const LensAnalysis& lens, double object_mm);
LensConjugates conjugates_of_magnification(const LensAnalysis& lens, double magnification);

/// The figures as lines of text for people; with the conjugates of one magnification when that is above 0.
std::string describe_lens(const Prescription& lens, double stop_radius_mm, double magnification);

}  // namespace rptv
