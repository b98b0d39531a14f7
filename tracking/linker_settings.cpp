// SPDX-License-Identifier: MIT
// The settings' meanings, bounds and contradictions.
#include "tracking/linker_settings.hpp"

#include <algorithm>
#include <cmath>

#include "core/error.hpp"

namespace rptv {

namespace {

std::string text_of(double value) {
  std::string text = std::to_string(value);
  return text.substr(0, text.find_last_not_of('0') + 1);
}

void require(bool holds, const std::string& message) {
  if (!holds) throw Error(ExitCode::configuration, message);
}

bool is_range(double value) { return value >= 1e-9 && value <= 1e9; }

}  // namespace

std::array<double, 3> LinkerSettings::range_mm() const noexcept {
  std::array<double, 3> range{search_range_mm, search_range_mm, search_range_mm};
  for (std::size_t axis = 0; axis < 3 && axis < search_range_xyz_mm.size(); ++axis)
    if (search_range_xyz_mm[axis] != 0) range[axis] = search_range_xyz_mm[axis];
  return range;
}

void LinkerSettings::check() const {
  for (const double range : range_mm())
    require(is_range(range), "search_range_mm is " + text_of(range) + "; give a length of 1e-9 to 1e9 mm");
  require(memory >= 0 && max_particles >= 1 && max_candidates >= 1,
          "memory " + std::to_string(memory) + ", max_particles " + std::to_string(max_particles) +
              ", max_candidates " + std::to_string(max_candidates) +
              ": memory must be 0 or more, the others 1 or more");
  const std::vector<std::string> kinds{"none", "velocity", "flow", "kalman", "kalman_acceleration"};
  require(std::find(kinds.begin(), kinds.end(), predict) != kinds.end(),
          "predict '" + predict + "' is not known; use none, velocity, flow, kalman or kalman_acceleration");
  require(start_up == "rest" || start_up == "nearest", "start_up '" + start_up + "' is not known; use rest or nearest");
  require(model_error_mm >= 0 && noise_mm >= 0 && flow_bin_mm >= 0 && gate_sigma >= 0 && adaptive_stop_mm >= 0 &&
              deadline_ms >= 0 && std::isfinite(model_error_mm + noise_mm + flow_bin_mm + gate_sigma + deadline_ms),
          "model_error_mm, noise_mm, flow_bin_mm, gate_sigma, adaptive_stop_mm and deadline_ms must be 0 or more");
  require(adaptive_stop_mm == 0 || (adaptive_step > 0 && adaptive_step < 1),
          "adaptive_step is " + text_of(adaptive_step) + "; give a factor between 0 and 1, as 0.95");
  require(gate_sigma == 0 || filters(), "gate_sigma needs a covariance; set predict to kalman, or gate_sigma to 0");
}

void LinkerSettings::fields(FieldList& list) {
  list.number("search_range_mm", search_range_mm, 1e-9, 1e9,
              "farthest a particle may be from its (predicted) position to be the same particle, mm");
  list.numbers("search_range_xyz_mm", search_range_xyz_mm, 3, 0, 1e9,
               "the same for each axis, mm, as depth is measured worse than x and y; 0: search_range_mm");
  list.integer("memory", memory, 0, 1'000'000,
               "frames that a particle may be unseen for and still keep its identity; counts frame indices");
  list.choice("predict", predict, {"none", "velocity", "flow", "kalman", "kalman_acceleration"},
              "where to look: at the last position, carried on with the last velocity, with the running mean flow, or "
              "where a Kalman filter of constant velocity or acceleration expects it");
  list.choice("start_up", start_up, {"nearest", "rest"},
              "what a new track is expected to do, if predict is not 'none': move like its neighbour, or stay");
  list.number("model_error_mm", model_error_mm, 0, 1e9,
              "rms displacement in one frame that a Kalman filter's model does not explain, mm; 0: search range / 3");
  list.number("noise_mm", noise_mm, 0, 1e9,
              "rms error of positions that come without covariance, mm; 0: search range / 20");
  list.number("gate_sigma", gate_sigma, 0, 1e3,
              "largest Mahalanobis distance from the expected position, beside the search range; 0: no limit");
  list.number("flow_bin_mm", flow_bin_mm, 0, 1e9,
              "edge of the cubes that predict = 'flow' averages over, mm; 0: 4 "
              "search ranges");
  list.number("adaptive_stop_mm", adaptive_stop_mm, 0, 1e9,
              "smallest search range that oversize subnetworks are retried with, mm; 0: no adaptive search");
  list.number("adaptive_step", adaptive_step, 0.01, 0.999, "factor of the range from one such try to the next");
  list.integer("max_subnet", max_subnet, 0, 10'000'000,
               "tracks in a subnetwork beyond which adaptive search begins; 0: only where the deadline asks for it");
  list.number("deadline_ms", deadline_ms, 0, 1e6,
              "time for one frame, ms; what is not solved by then is approximated and counted; 0: none, always exact");
  list.integer("max_particles", max_particles, 1, 10'000'000, "particles linked per frame; more are counted as lost");
  list.integer("max_tracks", max_tracks, 1, 10'000'000,
               "tracks alive at once, unseen ones included (at least max_particles are kept)");
  list.integer("max_candidates", max_candidates, 1, 1024,
               "nearest particles considered per track; linking is exact while no track has more in its range");
}

}  // namespace rptv
