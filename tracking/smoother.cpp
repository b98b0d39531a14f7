// SPDX-License-Identifier: MIT
// The backward pass, from the last frame that knows a track to the oldest one kept.
#include "tracking/smoother.hpp"

#include <Eigen/Dense>
#include <cmath>

#include "core/error.hpp"
#include "tracking/track_estimate.hpp"

namespace rptv {

namespace {

constexpr int kStates = 9;
using Covariance9 = Eigen::Matrix<double, kStates, kStates>;
using Vector9 = Eigen::Matrix<double, kStates, 1>;

Vector9 vector_of(const KalmanState& state) {
  Vector9 v;
  for (int i = 0; i < kStates; ++i) v(i) = state.x[static_cast<std::size_t>(i / 3)][static_cast<std::size_t>(i % 3)];
  return v;
}

Covariance9 covariance_of(const KalmanState& state) {
  Covariance9 c;
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = row; column < 3; ++column)
      for (std::size_t k = 0; k < 9; ++k) {
        const auto i = static_cast<Eigen::Index>(3 * row + k / 3);
        const auto j = static_cast<Eigen::Index>(3 * column + k % 3);
        c(i, j) = c(j, i) = state.p[KalmanState::block(row, column)][k];
      }
  return c;
}

void assign(KalmanState& state, const Vector9& x, const Covariance9& p) {
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t k = 0; k < 3; ++k) state.x[row][k] = x(static_cast<Eigen::Index>(3 * row + k));
    for (std::size_t column = row; column < 3; ++column)
      for (std::size_t k = 0; k < 9; ++k)
        state.p[KalmanState::block(row, column)][k] =
            p(static_cast<Eigen::Index>(3 * row + k / 3), static_cast<Eigen::Index>(3 * column + k % 3));
  }
}

Covariance9 transition(double dt) {
  Covariance9 f = Covariance9::Identity();
  for (int k = 0; k < 3; ++k) {
    f(k, 3 + k) = f(3 + k, 6 + k) = dt;
    f(k, 6 + k) = 0.5 * dt * dt;
  }
  return f;
}

/// P Fᵀ P_expected⁻¹. Scaled to a unit diagonal, as the units of the states are orders of magnitude apart; without
/// acceleration (order 2) its rows are 0.
Covariance9 gain_of(const Covariance9& p, const Covariance9& p_expected, double dt_s, std::size_t order) {
  const auto n = static_cast<Eigen::Index>(3 * order);
  Covariance9 scaled = Covariance9::Identity();
  Vector9 scale = Vector9::Ones();
  for (Eigen::Index i = 0; i < n; ++i) scale(i) = 1 / std::sqrt(p_expected(i, i));
  scaled.topLeftCorner(n, n) = p_expected.topLeftCorner(n, n);
  scaled = scale.asDiagonal() * scaled * scale.asDiagonal();
  Covariance9 across = Covariance9::Zero();
  across.topLeftCorner(n, n) = (transition(dt_s) * p).topLeftCorner(n, n);
  const Covariance9 solved = scaled.ldlt().solve(scale.asDiagonal() * across);
  return (scale.asDiagonal() * solved).transpose();
}

}  // namespace

void FixedLagSmoother::push(const Linker& linker, std::uint64_t frame, double t_s, const Tracks& tracks) {
  if (tracks.size() > 0 && linker.filter_of(0) == nullptr)
    throw Error(ExitCode::configuration, "smoothing needs a Kalman filter; set predict to kalman");
  const std::uint64_t sequence = first_ + frames_.size();
  const bool fault = linker.counters().clock_faults != clock_faults_;
  clock_faults_ = linker.counters().clock_faults;
  Frame& now = frames_.emplace_back(Frame{{frame, t_s, tracks}, linker.model(), {}});
  now.rows.resize(tracks.size());
  for (std::size_t row = 0; row < tracks.size(); ++row) {
    now.rows[row].state = *linker.filter_of(row);
    const auto [entry, unknown] = last_.try_emplace(tracks.particle[row]);
    Step& last = entry->second;
    if (!unknown && last.sequence >= first_ && !fault) {
      at(last.sequence).rows[last.row].next = {sequence, row};
      at(last.sequence).rows[last.row].continues = true;
    }
    last = {sequence, row};
  }
  for (const std::uint64_t id : tracks.deaths) last_.erase(id);
}

bool FixedLagSmoother::pop(SmoothedFrame& out, bool at_end) {
  if (frames_.empty() || (!at_end && frames_.size() <= lag_)) return false;
  Frame& oldest = frames_.front();
  Tracks& tracks = oldest.content.tracks;
  for (std::size_t row = 0; row < oldest.rows.size(); ++row) {
    const KalmanState state = smoothed(row);
    tracks.x_mm[row] = state.x[0][0];
    tracks.y_mm[row] = state.x[0][1];
    tracks.z_mm[row] = state.x[0][2];
    tracks.vx_mm_s[row] = state.x[1][0];
    tracks.vy_mm_s[row] = state.x[1][1];
    tracks.vz_mm_s[row] = state.x[1][2];
    tracks.estimate[row] = estimate_of(state);
  }
  out = std::move(oldest.content);
  frames_.pop_front();
  ++first_;
  return true;
}

/// Of a row of the oldest frame.
KalmanState FixedLagSmoother::smoothed(std::size_t row) {
  path_.assign(1, Step{first_, row});
  while (true) {
    const Row& last = at(path_.back().sequence).rows[path_.back().row];
    if (!last.continues) break;
    path_.push_back(last.next);
  }
  KalmanState later = at(path_.back().sequence).rows[path_.back().row].state;
  for (std::size_t i = path_.size() - 1; i-- > 0;) {
    KalmanState state = at(path_[i].sequence).rows[path_[i].row].state;
    KalmanState expected = state;
    state.take_prior(at(path_[i].sequence + 1).model);
    double dt_s = 0;  // frame by frame, as the linker has done it
    for (std::uint64_t s = path_[i].sequence + 1; s <= path_[i + 1].sequence; ++s) {
      const double step_s = at(s).content.t_s - at(s - 1).content.t_s;
      expected.predict(at(s).model, step_s);
      dt_s += step_s;
    }
    const Covariance9 p = covariance_of(state);
    const Covariance9 p_expected = covariance_of(expected);
    const Covariance9 gain = gain_of(p, p_expected, dt_s, at(path_[i].sequence + 1).model.order);
    const Vector9 x = vector_of(state) + gain * (vector_of(later) - vector_of(expected));
    Covariance9 smooth = p + gain * (covariance_of(later) - p_expected) * gain.transpose();
    smooth = 0.5 * (smooth + smooth.transpose()).eval();
    assign(state, x, smooth);
    later = state;
  }
  return later;
}

}  // namespace rptv
