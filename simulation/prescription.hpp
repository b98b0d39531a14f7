// SPDX-License-Identifier: MIT
// A lens as it is published: surfaces in the order of the light, with their glass, rims and stop.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace rptv {

/// One surface of revolution about the axis. Signs as in every lens table: light runs towards +z.
struct LensSurface {
  double radius_mm = 0;        ///< at the vertex, positive when the centre lies behind it; 0: plane
  double conic = 0;            ///< k = -e^2: 0 sphere, -1 paraboloid, < -1 hyperboloid
  double thickness_mm = 0;     ///< along the axis to the next vertex
  double index_after = 1;      ///< refractive index behind the surface
  double clear_radius_mm = 0;  ///< light beyond it is lost; 0: no rim

  double curvature() const noexcept { return radius_mm == 0 ? 0.0 : 1.0 / radius_mm; }
};

/// A prescription in air, lens frame: mm, origin at the first vertex, z in the direction of the light.
struct Prescription {
  static constexpr std::int64_t kSchema = 1;
  std::string name;    ///< one line for people
  std::string source;  ///< the publication that the numbers come from
  std::string note;    ///< what was changed or is not known
  std::vector<LensSurface> surfaces;
  std::size_t stop = 0;  ///< index of the surface that is the aperture stop

  /// Vertex of surface i.
  double vertex_z_mm(std::size_t surface) const noexcept;
  /// The same lens with the light entering at the other end.
  Prescription reversed() const;
  /// The same lens, every length times `factor`.
  Prescription scaled(double factor) const;
};

/// Reads a prescription file (TOML; format in docs/simulation.md) and refuses what is no lens: columns of different
/// length, negative thickness, index below 1, a rim wider than its sphere, no light along the axis, no power, or a
/// focal length other than the one that the file says was published. Throws Error(no_input, configuration) naming
/// file:line, value and next step. Set-up only.
Prescription read_prescription(const std::filesystem::path& file);

/// The same from TOML text; `origin` stands for the file's name in messages.
Prescription parse_prescription(std::string_view text, const std::string& origin);

/// True when a TOML file holds a prescription rather than a calibration or a scenario: it gives radii.
bool is_prescription(const std::filesystem::path& file);

}  // namespace rptv
