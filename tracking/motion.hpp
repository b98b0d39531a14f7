// SPDX-License-Identifier: MIT
// How tracks move: where each is expected next, and what a new position says about its motion.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "core/particles.hpp"
#include "tracking/candidates.hpp"
#include "tracking/flow_field.hpp"
#include "tracking/frame_clock.hpp"
#include "tracking/kalman.hpp"
#include "tracking/linker_settings.hpp"
#include "tracking/track_state.hpp"

namespace rptv {

/// The kinds of LinkerSettings::predict. One thread; after construction nothing allocates but seed().
class Motion final : public Gate {
 public:
  /// Settings must have been checked. `grid` and `particles` are read by admits(), within one frame.
  Motion(const LinkerSettings& settings, std::size_t max_tracks);

  /// Knowledge of the flow from before the first frame: for start-up and for the flow field. Set-up only.
  void seed(std::span<const VelocitySample> samples);

  /// The frame to come: its time, and the period that the noise of the models is for.
  void begin_frame(const FrameTime& now, std::int64_t period_ns) noexcept;
  /// Expected positions in the frame to come of tracks that were all last seen at `seen_ns`; moves their filters there.
  /// Once per track and frame.
  void expect(std::span<const TrackState> tracks, std::int64_t seen_ns, Spot* expected) noexcept;
  /// As expect(), for any time and without changing anything.
  Spot extrapolate(const TrackState& track, std::int64_t seen_ns, std::int64_t at_ns,
                   KalmanState* state) const noexcept;
  /// `track` goes on at a measured position. Without `timed`, dt is unknown and the velocity is kept.
  void move_on(TrackState& track, std::int64_t seen_ns, bool timed, const Spot& at) noexcept {
    if (timed) {
      const double per_s = 1e9 / static_cast<double>(now_.ns - seen_ns);
      track.vx_mm_s = (at.x_mm - track.x_mm) * per_s;
      track.vy_mm_s = (at.y_mm - track.y_mm) * per_s;
      track.vz_mm_s = (at.z_mm - track.z_mm) * per_s;
      if (flow_ != nullptr) learn(track, at);
    }
    track.x_mm = at.x_mm;
    track.y_mm = at.y_mm;
    track.z_mm = at.z_mm;
    ++track.age_frames;
  }
  /// The same through the track's filter.
  void filter_on(TrackState& track, bool timed, const Spot& at, const Covariance& covariance) noexcept;
  /// A new track; its position is set.
  void begin(TrackState& track, const Covariance& covariance) noexcept;
  void set_expected_velocity(TrackState& track, const VelocitySample& sample) noexcept;
  void end(const TrackState& track) noexcept;

  bool gated() const noexcept { return gate2_ > 0; }
  void gate_by(const CellGrid& grid, const Particles& particles, std::span<const TrackState> tracks) noexcept;
  bool admits(std::size_t source, std::uint32_t place) const noexcept override;

  bool moves() const noexcept { return kind_ != Kind::none; }
  bool starts_like_neighbours() const noexcept { return moves() && start_up_; }
  bool filters() const noexcept { return !filters_.empty(); }
  const KalmanState& filter(const TrackState& track) const noexcept { return filters_[track.slot]; }
  KalmanState& filter(const TrackState& track) noexcept { return filters_[track.slot]; }
  const KalmanModel& model() const noexcept { return model_; }
  FlowField* flow() noexcept { return flow_.get(); }
  const FlowField* flow() const noexcept { return flow_.get(); }
  /// Velocity of the nearest seed; false without seeds.
  bool nearest_seed(VelocitySample& at) const noexcept;
  void take_slot(TrackState& track) noexcept;
  void free_all_slots() noexcept;

 private:
  enum class Kind { none, velocity, flow, filter };
  void learn(const TrackState& before, const Spot& now) noexcept;
  Block3 noise_of(const Covariance& covariance) const noexcept;

  Kind kind_;
  bool start_up_;
  double gate2_, model_error_mm_, noise_mm_, range_mm_;
  FrameTime now_;
  KalmanModel model_;
  std::vector<KalmanState> filters_;
  std::vector<std::uint32_t> free_slots_;
  std::unique_ptr<FlowField> flow_;
  std::vector<VelocitySample> seeds_;
  std::unique_ptr<CellGrid> seed_grid_;
  const CellGrid* grid_ = nullptr;
  const Particles* particles_ = nullptr;
  std::span<const TrackState> gated_tracks_;
};

}  // namespace rptv
