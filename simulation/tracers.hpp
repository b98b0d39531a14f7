// SPDX-License-Identifier: MIT
// The particles of a scenario: where each one is at any time, and while which frames it is lit.
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "simulation/flow.hpp"
#include "simulation/random.hpp"
#include "simulation/scenario.hpp"
#include "simulation/truth.hpp"

namespace rptv {

/// One lit particle at one instant, object space, mm and mm/s.
struct Tracer {
  std::uint64_t particle = 0;
  std::uint64_t age_frames = 0;  ///< frames in which it was lit before
  Vector3 position, velocity;
};

/// Uniform in the lit box at every time: the seeding reaches upstream as far as the drift carries particles during the
/// run. A particle is lit while its rest position (without the swing) is in the box, so that the swing never cuts one
/// in two. Layers and random positions do not move; the latter are new particles in every frame. A table gives
/// positions (and velocities, when it has them) as they are. Immutable after construction; any thread.
class Tracers {
 public:
  /// Throws Error(no_input, bad_data) when a table of positions cannot be read.
  explicit Tracers(const ScenarioSettings& scenario);
  double time_s(std::uint64_t frame) const noexcept { return static_cast<double>(frame) / scenario_.rate_hz; }
  /// The lit particles of a frame, by rising identity.
  std::vector<Tracer> lit(std::uint64_t frame) const;
  std::size_t size() const noexcept { return rest_.size(); }  ///< moving or still ones
  const Flow& flow() const noexcept { return *flow_; }

 private:
  void seed_layers();
  void seed_box();
  void read_table();
  bool is_lit(std::size_t tracer, double time_s) const noexcept;
  std::vector<Tracer> random_positions(std::uint64_t frame) const;

  ScenarioSettings scenario_;
  std::shared_ptr<const Flow> flow_;
  double half_depth_;                  ///< of the lit box, along z
  std::vector<Vector3> rest_, drift_;  ///< positions at t = 0, mean velocities
  std::vector<std::uint64_t> first_lit_;
  std::map<std::uint64_t, std::vector<Tracer>> table_;  ///< by frame
};

/// Truth row of a tracer; `in_view` is for the caller to fill.
TruthRow truth_row(const Tracer& tracer, std::uint64_t frame, double time_s);

}  // namespace rptv
