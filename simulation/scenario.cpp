// SPDX-License-Identifier: MIT
// The fields of a scenario, its reading and its checks.
#include "simulation/scenario.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"

namespace rptv {

void ScenarioSettings::fields(FieldList& list) {
  list.integer("seed", seed, 0, std::numeric_limits<std::int64_t>::max(), "seed of every random number");
  list.integer("frames", frames, 1, 10000000, "number of frames");
  list.number("rate_hz", rate_hz, 1e-3, 1e6, "frame rate, Hz");
  list.integer("rays_per_particle", rays_per_particle, 16, 1000000, "quadrature rays per particle image");
  list.section("flow", flow);
  list.section("duct", duct);
  list.section("waves", waves);
  list.section("layers", layers);
  list.section("seeding", seeding);
  list.section("main_lens", main_lens);
  list.section("lenslets", lenslets);
  list.section("camera", camera);
  list.section("views", views);
}

ScenarioSettings read_scenario(const std::filesystem::path& file) {
  ScenarioSettings scenario;
  FieldList list;
  scenario.fields(list);
  read_toml_file(file, "scenario", kScenarioSchema, list);
  const auto beside = [&](std::string& path) {  // paths in the file count from its folder
    path = std::filesystem::absolute(file.parent_path() / path).lexically_normal();
  };
  if (scenario.main_lens.prescription.ends_with(".toml")) beside(scenario.main_lens.prescription);
  if (!scenario.flow.table.empty()) beside(scenario.flow.table);
  if (scenario.views.rig.ends_with(".toml")) beside(scenario.views.rig);
  check_scenario(scenario, file.string());
  return scenario;
}

namespace {

class Check {
 public:
  Check(const ScenarioSettings& scenario, const std::string& origin) : scenario_(scenario), origin_(origin) {}

  void flow() const {
    const auto& box = scenario_.seeding;
    if (scenario_.flow.kind == "oscillating_wall" && scenario_.flow.wall_y_mm >= 0.5 * box.volume_y_mm)
      fail(fmt::format("flow.wall_y_mm {} is above the box, which ends at y = {} mm: no fluid is left; lower the wall",
                       scenario_.flow.wall_y_mm, 0.5 * box.volume_y_mm));
    if (scenario_.flow.kind == "table" && scenario_.flow.table.empty())
      fail("flow.table is missing; give a points or tracks table (CSV)");
    if (scenario_.flow.kind == "layers" && scenario_.layers.z_mm.empty())
      fail("layers.z_mm is empty: no layer to see; give one height per layer");
  }

  void lens() const {
    const auto& lens = scenario_.main_lens;
    if (lens.model == "thick_lens") return thick_lens();
    if (lens.model == "aplanat") return aplanat();
    if (lens.prescription.empty())
      fail("main_lens.prescription is missing; name an installed lens (rapidptv info --lenses) or give a file");
    if (lens.rim_z_mm.size() != lens.rim_radius_mm.size())
      fail(fmt::format("main_lens.rim_z_mm has {} values but main_lens.rim_radius_mm has {}; give one radius per rim",
                       lens.rim_z_mm.size(), lens.rim_radius_mm.size()));
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw Error(ExitCode::configuration, origin_ + ": " + what); }

  void thick_lens() const {
    const auto& lens = scenario_.main_lens;
    const double focus = lens.magnification > 0 ? lens.efl_mm * (1 + 1 / lens.magnification) : lens.focus_distance_mm;
    const double nearest = focus - half_depth_mm(scenario_);
    if (nearest <= 1.02 * lens.efl_mm)
      fail(
          fmt::format("main_lens.focus_distance_mm {} puts the near face of the box at {} mm, within the focal length "
                      "{} mm: no real image; enlarge it or make seeding.volume_z_mm smaller",
                      focus, nearest, lens.efl_mm));
    if (std::abs(lens.entrance_pupil_mm) >= lens.efl_mm)
      fail(fmt::format("main_lens.entrance_pupil_mm {} lies beyond the focal length {} mm: bring it nearer to H1",
                       lens.entrance_pupil_mm, lens.efl_mm));
  }

  void aplanat() const {
    const auto& lens = scenario_.main_lens;
    if (!(lens.magnification > 0)) fail("main_lens.magnification is missing; an aplanat needs it above 0");
    if (lens.numerical_aperture >= std::min(1.0, lens.medium_index))
      fail(fmt::format("main_lens.numerical_aperture {} cannot be had through a dry window (index {}); make it smaller",
                       lens.numerical_aperture, lens.medium_index));
    if (half_depth_mm(scenario_) > lens.window_mm && lens.medium_index > 1)
      fail(
          fmt::format("main_lens.window_mm {} is nearer than the particles reach ({} mm above the focused plane); "
                      "enlarge it or make the depth smaller",
                      lens.window_mm, half_depth_mm(scenario_)));
  }

  const ScenarioSettings& scenario_;
  const std::string& origin_;
};

}  // namespace

double half_depth_mm(const ScenarioSettings& scenario) {
  if (scenario.flow.kind == "duct") return 0.5 * std::min(scenario.duct.height_mm, scenario.seeding.volume_z_mm);
  if (scenario.flow.kind != "layers") return 0.5 * scenario.seeding.volume_z_mm;
  double reach = 0;
  for (const double z : scenario.layers.z_mm) reach = std::max(reach, std::abs(z));
  return reach;
}

void check_scenario(const ScenarioSettings& scenario, const std::string& origin) {
  const Check check(scenario, origin);
  if (scenario.views.rig.empty()) check.lens();
  check.flow();
}

}  // namespace rptv
