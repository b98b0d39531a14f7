// SPDX-License-Identifier: MIT
// Wording of scores and profiles.
#include "simulation/score_report.hpp"

#include <fmt/format.h>

#include <cmath>

namespace rptv {

namespace {

std::string triple(const std::array<double, 3>& values) {
  return fmt::format("[{},{},{}]", values[0], values[1], values[2]);
}

std::string json_of(const AxisErrors& errors) {
  return fmt::format(R"({{"mean":{},"mean_absolute":{},"rms":{}}})", triple(errors.mean), triple(errors.mean_absolute),
                     triple(errors.rms));
}

std::string rows_of(const AxisErrors& errors, const char* what, const char* unit) {
  std::string text = fmt::format("{:<22}{:>10}{:>10}{:>10}   {}\n", what, "x", "y", "z", unit);
  const auto row = [&](const char* name, const std::array<double, 3>& v) {
    text += fmt::format("{:<22}{:>10.4f}{:>10.4f}{:>10.4f}\n", name, v[0], v[1], v[2]);
  };
  row("  bias", errors.mean);
  row("  mean |error|", errors.mean_absolute);
  row("  rms", errors.rms);
  return text;
}

std::string share(double part) { return fmt::format("{:.2f} %", 100.0 * part); }

}  // namespace

std::string to_text(const Score& score, const ScoreSettings& settings) {
  const auto& d = score.detection;
  std::string text = fmt::format(
      "{:<22}{} ({} found of {} in view, {} frames)\n{:<22}{} ({} ghosts among {} measured; {} more are partly "
      "visible)\n",
      "recall", share(d.recall), d.found, d.truth, d.frames, "precision", share(d.precision), d.ghosts, d.measured,
      d.partly_visible);
  text += fmt::format("{:<22}{:.4g} x {:.4g} x {:.4g} mm, one to one, nearest first\n", "found within",
                      settings.radius_mm[0], settings.radius_mm[1], settings.radius_mm[2]);
  text += rows_of(d.position_mm, "position error", "mm");
  if (!score.linked) return text;
  const auto& t = score.track;
  text += rows_of(t.velocity_mm_s, "velocity error", "mm/s");
  text += fmt::format("{:<22}{} of {} true trajectories found by {} tracks, {} of them ghosts\n", "tracks",
                      t.trajectories_found, t.trajectories, t.tracks, t.ghost_tracks);
  text +=
      fmt::format("{:<22}{}\n{:<22}{}\n{:<22}{:.3f} tracks per trajectory\n{:<22}{}\n", "purity", share(t.purity),
                  "coverage", share(t.coverage), "fragmentation", t.fragmentation, "identity switches", t.id_switches);
  return text;
}

std::string to_text(const WallProfile& profile) {
  std::string text = fmt::format("{:>9}{:>14}{:>10}{:>12}{:>10}{:>8}\n{:>9}{:>14}{:>10}{:>12}{:>10}\n", "height",
                                 "amplitude", "theory", "phase", "theory", "tracks", "mm", "mm", "mm", "rad", "rad");
  for (const auto& bin : profile.bins)
    text += fmt::format("{:>9.3f}{:>14.5f}{:>10.5f}{:>12.3f}{:>10.3f}{:>8}\n", bin.height_mm, bin.amplitude_mm,
                        bin.theory_amplitude_mm, bin.phase_rad, bin.theory_phase_rad, bin.tracks);
  text += fmt::format("amplitude: rms deviation {:.5f} mm ({} of the wall's); phase: rms deviation {:.4f} rad\n",
                      profile.amplitude_rms_mm, share(profile.amplitude_rms_relative), profile.phase_rms_rad);
  text += fmt::format(
      "wall amplitude {:.4f} mm (theory {:.4f}), Stokes layer {:.4f} mm (theory {:.4f}), phase {:.4f} rad\n",
      profile.wall_amplitude_mm, profile.theory.wall_amplitude_mm, profile.stokes_layer_mm,
      profile.theory.stokes_layer_mm, profile.wall_phase_rad);
  return text;
}

std::string to_text(const DuctProfile& profile) {
  std::string text = fmt::format("{:>10}{:>10}{:>12}{:>8}\n{:>10}{:>10}{:>12}\n", "velocity", "theory", "deviation",
                                 "steps", "mm/s", "mm/s", "");
  for (const auto& bin : profile.bins)
    text += fmt::format("{:>10.4f}{:>10.4f}{:>12}{:>8}\n", bin.velocity_mm_s, bin.theory_mm_s, share(bin.deviation),
                        bin.steps);
  text += fmt::format(
      "flow rate {:.4f} ul/min, standard error {:.4f} (theory {:.4f}); profile off by {} in the centre, {} near walls "
      "and in corners\n",
      profile.flow_rate_ul_min, profile.flow_rate_sigma_ul_min, profile.theory.flow_rate_ul_min,
      share(profile.centre_deviation), share(profile.wall_deviation));
  return text;
}

std::string to_json(const Score& score) {
  const auto& d = score.detection;
  std::string text = fmt::format(
      R"({{"detection":{{"frames":{},"truth":{},"found":{},"measured":{},"partly_visible":{},"ghosts":{},"recall":{},"precision":{},"rms_mm":{},"position_mm":{}}})",
      d.frames, d.truth, d.found, d.measured, d.partly_visible, d.ghosts, d.recall, d.precision, d.rms_mm,
      json_of(d.position_mm));
  if (score.linked) {
    const auto& t = score.track;
    text += fmt::format(
        R"(,"track":{{"trajectories":{},"trajectories_found":{},"tracks":{},"ghost_tracks":{},"purity":{},"coverage":{},"fragmentation":{},"id_switches":{},"velocity_mm_s":{}}})",
        t.trajectories, t.trajectories_found, t.tracks, t.ghost_tracks, t.purity, t.coverage, t.fragmentation,
        t.id_switches, json_of(t.velocity_mm_s));
  }
  return text + "}";
}

std::string to_json(const WallProfile& profile) {
  std::string text = fmt::format(
      R"({{"tracks":{},"amplitude_rms_mm":{},"amplitude_rms_relative":{},"phase_rms_rad":{},"wall_amplitude_mm":{},"stokes_layer_mm":{},"wall_phase_rad":{},"bins":[)",
      profile.tracks, profile.amplitude_rms_mm, profile.amplitude_rms_relative, profile.phase_rms_rad,
      profile.wall_amplitude_mm, profile.stokes_layer_mm, profile.wall_phase_rad);
  for (std::size_t i = 0; i < profile.bins.size(); ++i) {
    const auto& bin = profile.bins[i];
    text += fmt::format(
        R"({}{{"height_mm":{},"amplitude_mm":{},"phase_rad":{},"amplitude_sigma_mm":{},"theory_amplitude_mm":{},"theory_phase_rad":{},"tracks":{},"points":{}}})",
        i == 0 ? "" : ",", bin.height_mm, bin.amplitude_mm, bin.phase_rad, bin.amplitude_sigma_mm,
        bin.theory_amplitude_mm, bin.theory_phase_rad, bin.tracks, bin.points);
  }
  return text + "]}";
}

std::string to_json(const DuctProfile& profile) {
  const auto number = [](double value) { return std::isnan(value) ? "null" : fmt::format("{}", value); };
  std::string text = fmt::format(
      R"({{"steps":{},"flow_rate_ul_min":{},"flow_rate_sigma_ul_min":{},"centre_deviation":{},"wall_deviation":{},"bins":[)",
      profile.steps, profile.flow_rate_ul_min, profile.flow_rate_sigma_ul_min, number(profile.centre_deviation),
      number(profile.wall_deviation));
  for (std::size_t i = 0; i < profile.bins.size(); ++i) {
    const auto& bin = profile.bins[i];
    text += fmt::format(R"({}{{"velocity_mm_s":{},"theory_mm_s":{},"deviation":{},"steps":{}}})", i == 0 ? "" : ",",
                        bin.velocity_mm_s, bin.theory_mm_s, bin.deviation, bin.steps);
  }
  return text + "]}";
}

}  // namespace rptv
