// SPDX-License-Identifier: MIT
// Standing still, last velocity, mean flow, Kalman filter; and what a new track starts with.
#include "tracking/motion.hpp"

#include <algorithm>

#include "tracking/nearest.hpp"

namespace rptv {

namespace {

constexpr std::size_t kFlowBins = std::size_t{1} << 16;
constexpr double kRangePerSigma = 3;   // unexplained displacement: the range is three of its σ
constexpr double kRangePerNoise = 20;  // positions without covariance
constexpr double kBinPerRange = 4;

double seconds(std::int64_t ns) noexcept { return static_cast<double>(ns) * 1e-9; }
double largest(const std::array<double, 3>& values) { return *std::max_element(values.begin(), values.end()); }

}  // namespace

Motion::Motion(const LinkerSettings& settings, std::size_t max_tracks)
    : kind_(settings.filters()               ? Kind::filter
            : settings.predict == "velocity" ? Kind::velocity
            : settings.predict == "flow"     ? Kind::flow
                                             : Kind::none),
      start_up_(settings.start_up == "nearest"),
      gate2_(settings.gate_sigma * settings.gate_sigma),
      model_error_mm_(settings.model_error_mm),
      noise_mm_(settings.noise_mm),
      range_mm_(largest(settings.range_mm())) {
  if (model_error_mm_ == 0) model_error_mm_ = range_mm_ / kRangePerSigma;
  if (noise_mm_ == 0) noise_mm_ = range_mm_ / kRangePerNoise;
  model_.order = settings.predict == "kalman_acceleration" ? 3 : 2;
  if (kind_ == Kind::filter) {
    filters_.resize(max_tracks);
    free_slots_.reserve(max_tracks);
    free_all_slots();
  }
  const double bin_mm = settings.flow_bin_mm > 0 ? settings.flow_bin_mm : kBinPerRange * range_mm_;
  if (kind_ == Kind::flow) flow_ = std::make_unique<FlowField>(bin_mm, kFlowBins);
}

void Motion::seed(std::span<const VelocitySample> samples) {
  seeds_.assign(samples.begin(), samples.end());
  std::vector<double> x, y, z;
  for (const VelocitySample& s : seeds_) {
    x.push_back(s.x_mm);
    y.push_back(s.y_mm);
    z.push_back(s.z_mm);
    if (flow_ != nullptr) flow_->add(s);
  }
  seed_grid_ = std::make_unique<CellGrid>(seeds_.size());
  seed_grid_->build(x.data(), y.data(), z.data(), seeds_.size(), {range_mm_, range_mm_, range_mm_});
}

bool Motion::nearest_seed(VelocitySample& at) const noexcept {
  if (seed_grid_ == nullptr) return false;
  const std::uint32_t place = seed_grid_->find_nearest(at.x_mm, at.y_mm, at.z_mm, [](std::uint32_t) { return true; });
  if (place == CellGrid::kNone) return false;
  const VelocitySample& seed = seeds_[seed_grid_->original(place)];
  at.vx_mm_s = seed.vx_mm_s;
  at.vy_mm_s = seed.vy_mm_s;
  at.vz_mm_s = seed.vz_mm_s;
  return true;
}

void Motion::begin_frame(const FrameTime& now, std::int64_t period_ns) noexcept {
  now_ = now;
  if (period_ns <= 0) return;
  const double period_s = seconds(period_ns);
  model_.acceleration_mm_s2 = 2 * model_error_mm_ / (period_s * period_s);
  model_.velocity_prior_mm_s = range_mm_ / period_s;
}

void Motion::expect(std::span<const TrackState> tracks, std::int64_t seen_ns, Spot* expected) noexcept {
  const double dt_s = kind_ == Kind::none ? 0 : seconds(now_.ns - seen_ns);
  for (const TrackState& t : tracks) {
    Spot& spot = *expected++;
    if (kind_ == Kind::filter) {
      KalmanState& state = filter(t);
      state.predict(model_, seconds(now_.ns - state.at_ns));
      state.at_ns = now_.ns;
      spot = {state.x[0][0], state.x[0][1], state.x[0][2]};
    } else if (kind_ == Kind::flow) {
      spot = extrapolate(t, seen_ns, now_.ns, nullptr);
    } else {
      spot = {t.x_mm + t.vx_mm_s * dt_s, t.y_mm + t.vy_mm_s * dt_s, t.z_mm + t.vz_mm_s * dt_s};
    }
  }
}

Spot Motion::extrapolate(const TrackState& track, std::int64_t seen_ns, std::int64_t at_ns,
                         KalmanState* state) const noexcept {
  const double dt_s = seconds(at_ns - seen_ns);
  if (kind_ == Kind::none) return {track.x_mm, track.y_mm, track.z_mm};
  if (kind_ == Kind::filter) {
    KalmanState later = filter(track);
    later.predict(model_, seconds(at_ns - later.at_ns));
    later.at_ns = at_ns;
    if (state != nullptr) *state = later;
    return {later.x[0][0], later.x[0][1], later.x[0][2]};
  }
  VelocitySample v{track.x_mm, track.y_mm, track.z_mm, track.vx_mm_s, track.vy_mm_s, track.vz_mm_s};
  if (flow_ != nullptr && flow_->look_up(v)) {  // the midpoint rule: half a step on, the flow is another
    VelocitySample half{v.x_mm + v.vx_mm_s * dt_s / 2, v.y_mm + v.vy_mm_s * dt_s / 2, v.z_mm + v.vz_mm_s * dt_s / 2};
    if (flow_->look_up(half)) v = {v.x_mm, v.y_mm, v.z_mm, half.vx_mm_s, half.vy_mm_s, half.vz_mm_s};
  }
  return {v.x_mm + v.vx_mm_s * dt_s, v.y_mm + v.vy_mm_s * dt_s, v.z_mm + v.vz_mm_s * dt_s};
}

/// A velocity between two frames belongs to the middle of the way.
void Motion::learn(const TrackState& before, const Spot& now) noexcept {
  flow_->add({(before.x_mm + now.x_mm) / 2, (before.y_mm + now.y_mm) / 2, (before.z_mm + now.z_mm) / 2, before.vx_mm_s,
              before.vy_mm_s, before.vz_mm_s});
}

Block3 Motion::noise_of(const Covariance& covariance) const noexcept {
  const bool given = covariance[0] > 0 && covariance[3] > 0 && covariance[5] > 0;
  if (given) return full(covariance);
  const double variance = noise_mm_ * noise_mm_;
  return {variance, 0, 0, 0, variance, 0, 0, 0, variance};
}

void Motion::filter_on(TrackState& track, bool timed, const Spot& at, const Covariance& covariance) noexcept {
  KalmanState& state = filter(track);
  const Block3 noise = noise_of(covariance);
  const std::array<double, 3> position{at.x_mm, at.y_mm, at.z_mm};
  if (!timed || !state.update(model_, position, noise)) state.replace_position(position, noise);
  track.x_mm = state.x[0][0];
  track.y_mm = state.x[0][1];
  track.z_mm = state.x[0][2];
  track.vx_mm_s = state.x[1][0];
  track.vy_mm_s = state.x[1][1];
  track.vz_mm_s = state.x[1][2];
  ++track.age_frames;
}

void Motion::begin(TrackState& track, const Covariance& covariance) noexcept {
  if (kind_ != Kind::filter) return;
  take_slot(track);
  filter(track).begin({track.x_mm, track.y_mm, track.z_mm}, noise_of(covariance), {});
  filter(track).at_ns = now_.ns;
}

void Motion::set_expected_velocity(TrackState& track, const VelocitySample& sample) noexcept {
  track.vx_mm_s = sample.vx_mm_s;
  track.vy_mm_s = sample.vy_mm_s;
  track.vz_mm_s = sample.vz_mm_s;
  if (kind_ == Kind::filter) filter(track).x[1] = {sample.vx_mm_s, sample.vy_mm_s, sample.vz_mm_s};
}

void Motion::end(const TrackState& track) noexcept {
  if (kind_ == Kind::filter) free_slots_.push_back(track.slot);
}

void Motion::take_slot(TrackState& track) noexcept {
  track.slot = free_slots_.back();
  free_slots_.pop_back();
}

void Motion::free_all_slots() noexcept {
  free_slots_.clear();
  for (std::size_t slot = filters_.size(); slot-- > 0;) free_slots_.push_back(static_cast<std::uint32_t>(slot));
}

void Motion::gate_by(const CellGrid& grid, const Particles& particles, std::span<const TrackState> tracks) noexcept {
  grid_ = &grid;
  particles_ = &particles;
  gated_tracks_ = tracks;
}

bool Motion::admits(std::size_t source, std::uint32_t place) const noexcept {
  const KalmanState& state = filter(gated_tracks_[source]);
  Block3 innovation = noise_of(particles_->covariance_mm2[grid_->original(place)]);
  for (std::size_t i = 0; i < 9; ++i) innovation[i] += state.p[0][i];
  const std::array<double, 3> d{grid_->x(place) - state.x[0][0], grid_->y(place) - state.x[0][1],
                                grid_->z(place) - state.x[0][2]};
  return mahalanobis2(d, innovation) <= gate2_;
}

}  // namespace rptv
