// SPDX-License-Identifier: MIT
// Prescription files: columns of numbers in TOML, checked one by one and against each other.
#include "simulation/prescription.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

#include "core/error.hpp"
#include "core/settings.hpp"
#include "simulation/lens_analysis.hpp"
#include "simulation/lens_tracer.hpp"

namespace rptv {

namespace {

constexpr std::size_t kMostSurfaces = 200;
constexpr double kPublishedTolerance = 0.01;  // of a focal length: lens tables are rounded

/// The file as written: one array per column of the lens table.
struct Columns {
  std::string name, source, note;
  double scale = 1, published_focal_length_mm = 0;
  bool reversed = false;
  std::vector<double> radius_mm, thickness_mm, index_after, clear_diameter_mm, conic;
  std::int64_t stop = 0;

  void fields(FieldList& list) {
    list.text("name", name, "what the lens is").required = true;
    list.text("source", source, "publication that the numbers come from").required = true;
    list.text("note", note, "what was changed or is not known");
    list.number("scale", scale, 1e-3, 1e3, "factor on every length below, for a lens of another size");
    list.flag("reversed", reversed, "the light enters at the last surface: as published for the other direction");
    list.number("published_focal_length_mm", published_focal_length_mm, 0, 1e5,
                "focal length that the publication states for the numbers below; 0: none; it is checked to 1 %");
    surfaces(list);
  }

 private:
  struct Table {
    Columns& columns;
    void fields(FieldList& list) {
      list.numbers("radius_mm", columns.radius_mm, 0, -1e6, 1e6, "radius of curvature; 0: plane").required = true;
      list.numbers("thickness_mm", columns.thickness_mm, 0, 0, 1e5,
                   "distance to the next vertex; the last does not count")
          .required = true;
      list.numbers("index_after", columns.index_after, 0, 1, 4, "refractive index behind the surface; 1: air")
          .required = true;
      list.numbers("clear_diameter_mm", columns.clear_diameter_mm, 0, 0, 1e5, "clear diameter; 0: no rim").required =
          true;
      list.numbers("conic", columns.conic, 0, -1e3, 1e3, "conic constant; empty: all spheres");
      list.integer("stop", columns.stop, 1, kMostSurfaces, "number of the surface that is the stop, from 1").required =
          true;
    }
  };
  void surfaces(FieldList& list) {
    Table table{*this};
    list.section("surfaces", table);
  }
};

/// `origin:line` of the assignment to `key`, or `origin` when it has none.
std::string place_of(std::string_view text, const std::string& origin, std::string_view key) {
  std::size_t line = 1;
  for (std::size_t begin = 0; begin < text.size(); ++line) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string_view row = text.substr(begin, end - begin);
    row.remove_prefix(std::min(row.find_first_not_of(" \t"), row.size()));
    if (row.starts_with(key) && row.substr(key.size()).find_first_not_of(" \t") == row.substr(key.size()).find('='))
      return fmt::format("{}:{}", origin, line);
    begin = end + 1;
  }
  return origin;
}

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class Reading {
 public:
  Reading(std::string_view text, const std::string& origin) : text_(text), origin_(origin) {}

  Prescription read() {
    FieldList list;
    columns_.fields(list);
    read_toml_text(text_, origin_, "lens prescription", Prescription::kSchema, list);
    check_lengths();
    Prescription lens = assemble();
    check_rims(lens);
    check_light(lens);
    if (columns_.scale != 1) lens = lens.scaled(columns_.scale);
    return columns_.reversed ? lens.reversed() : lens;
  }

 private:
  [[noreturn]] void refuse(std::string_view key, const std::string& what) const {
    throw Error(ExitCode::configuration, place_of(text_, origin_, key) + ": " + what);
  }

  void check_lengths() const {
    const std::size_t count = columns_.radius_mm.size();
    if (count == 0) refuse("radius_mm", "surfaces.radius_mm is empty: no lens; give one radius per surface");
    if (count > kMostSurfaces)
      refuse("radius_mm", fmt::format("surfaces.radius_mm has {} values; at most {} are read", count, kMostSurfaces));
    const auto same = [&](std::string_view key, const std::vector<double>& column) {
      if (column.size() != count)
        refuse(key, fmt::format("surfaces.{} has {} values but surfaces.radius_mm has {}; give one per surface", key,
                                column.size(), count));
    };
    same("thickness_mm", columns_.thickness_mm);
    same("index_after", columns_.index_after);
    same("clear_diameter_mm", columns_.clear_diameter_mm);
    if (!columns_.conic.empty()) same("conic", columns_.conic);
    if (static_cast<std::size_t>(columns_.stop) > count)
      refuse("stop", fmt::format("surfaces.stop = {} but there are {} surfaces", columns_.stop, count));
    if (columns_.index_after.back() != 1)
      refuse("index_after",
             fmt::format("surfaces.index_after ends in {}: the lens must end in air (1)", columns_.index_after.back()));
  }

  Prescription assemble() const {
    Prescription lens{columns_.name, columns_.source, columns_.note, {}, static_cast<std::size_t>(columns_.stop - 1)};
    for (std::size_t i = 0; i < columns_.radius_mm.size(); ++i)
      lens.surfaces.push_back({columns_.radius_mm[i], columns_.conic.empty() ? 0.0 : columns_.conic[i],
                               columns_.thickness_mm[i], columns_.index_after[i], 0.5 * columns_.clear_diameter_mm[i]});
    lens.surfaces.back().thickness_mm = 0;
    return lens;
  }

  void check_rims(const Prescription& lens) const {
    if (!(lens.surfaces[lens.stop].clear_radius_mm > 0))
      refuse("clear_diameter_mm", fmt::format("surfaces.clear_diameter_mm of the stop (surface {}) is 0: the stop must "
                                              "have a diameter",
                                              lens.stop + 1));
    for (std::size_t i = 0; i < lens.surfaces.size(); ++i) {
      const LensSurface& surface = lens.surfaces[i];
      const double reach = surface.clear_radius_mm * surface.curvature();
      if ((1 + surface.conic) * reach * reach >= 1)
        refuse(
            "clear_diameter_mm",
            fmt::format("surface {} has a clear diameter of {} mm but radius {} mm: the surface ends before its rim; "
                        "check both numbers",
                        i + 1, 2 * surface.clear_radius_mm, surface.radius_mm));
    }
  }

  void check_light(const Prescription& lens) const {
    const double power = lens_power(lens);
    if (!(std::abs(power) > 1e-7))
      refuse("radius_mm", "the surfaces have no power together (afocal): this lens forms no image; check the radii");
    const double focal = 1 / power, published = columns_.published_focal_length_mm;
    if (published > 0 && std::abs(focal / published - 1) > kPublishedTolerance)
      refuse(
          "published_focal_length_mm",
          fmt::format("published_focal_length_mm = {} but the surfaces have {:.4f} mm: a number is wrong; compare the "
                      "table with its source",
                      published, focal));
    const LensTracer tracer(lens, 0, {});
    LensRay axis{0, 0, -1, 0, 0, 1};
    LensRay beside{0.3 * lens.surfaces[lens.stop].clear_radius_mm, 0, -1, 0, 0, 1};
    if (!tracer.forward(axis) || !tracer.forward(beside))
      refuse("radius_mm",
             "light along the axis does not get through (it misses a surface, is totally reflected or stopped by a "
             "rim); check radii, indices and clear diameters");
  }

  std::string_view text_;
  const std::string& origin_;
  Columns columns_;
};

}  // namespace

double Prescription::vertex_z_mm(std::size_t surface) const noexcept {
  double z = 0;
  for (std::size_t i = 0; i < surface; ++i) z += surfaces[i].thickness_mm;
  return z;
}

Prescription Prescription::reversed() const {
  Prescription out = *this;
  const std::size_t count = surfaces.size();
  for (std::size_t i = 0; i < count; ++i) {
    const LensSurface& from = surfaces[count - 1 - i];
    const bool last = i + 1 == count;
    out.surfaces[i] = {-from.radius_mm, from.conic, last ? 0.0 : surfaces[count - 2 - i].thickness_mm,
                       last ? 1.0 : surfaces[count - 2 - i].index_after, from.clear_radius_mm};
  }
  out.stop = count - 1 - stop;
  return out;
}

Prescription Prescription::scaled(double factor) const {
  Prescription out = *this;
  for (auto& surface : out.surfaces) {
    surface.radius_mm *= factor;
    surface.thickness_mm *= factor;
    surface.clear_radius_mm *= factor;
  }
  return out;
}

Prescription parse_prescription(std::string_view text, const std::string& origin) {
  return Reading(text, origin).read();
}

Prescription read_prescription(const std::filesystem::path& file) {
  FieldList list;
  Columns columns;
  columns.fields(list);
  read_toml_file(file, "lens prescription", Prescription::kSchema, list);  // refuses what cannot be read
  return parse_prescription(text_of(file), file.string());
}

bool is_prescription(const std::filesystem::path& file) {
  return place_of(text_of(file), "", "radius_mm").starts_with(':');
}

}  // namespace rptv
