// SPDX-License-Identifier: MIT
// One track's Kalman filter: constant velocity or constant acceleration in three dimensions, any covariance.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/particles.hpp"

namespace rptv {

/// 3×3 matrix by rows.
using Block3 = std::array<double, 9>;

/// Noise and order of the model; the same for all tracks of a frame.
struct KalmanModel {
  std::size_t order = 2;           ///< 2: position and velocity; 3: acceleration too
  double acceleration_mm_s2 = 0;   ///< σ of the acceleration (order 2) or of its change (order 3), per time update
  double velocity_prior_mm_s = 0;  ///< σ of the velocity of a track seen once
  bool operator==(const KalmanModel&) const = default;
};

/// State vector (position mm, velocity mm/s, acceleration mm/s²) and its covariance as 3×3 blocks. Time update: x ← F
/// x, P ← F P Fᵀ + Q with F of uniform acceleration and Q of an acceleration that is constant over the step
/// (Bar-Shalom, Li & Kirubarajan, Estimation with Applications to Tracking and Navigation, 2001, sec. 6.3). Measurement
/// update in Joseph's form, P ← (I − K H) P (I − K H)ᵀ + K R Kᵀ, which stays symmetric and positive. Pure arithmetic;
/// one thread.
struct KalmanState {
  std::array<std::array<double, 3>, 3> x{};  ///< x[0] position, x[1] velocity, x[2] acceleration
  std::array<Block3, 6> p{};                 ///< blocks 00 01 02 11 12 22; those below are their transposes
  std::int64_t at_ns = 0;                    ///< FrameClock time of the state; kept by the caller
  bool fresh = true;                         ///< seen once: what is not position is a guess

  static constexpr std::size_t block(std::size_t row, std::size_t column) noexcept {
    return row == 0 ? column : row == 1 ? 2 + column : 5;
  }
  /// At the first measurement. The guess of the velocity enters with the model's prior at the first time update.
  void begin(const std::array<double, 3>& position, const Block3& noise,
             const std::array<double, 3>& velocity) noexcept;
  /// Of what a single measurement says nothing about; part of the first time update.
  void take_prior(const KalmanModel& model) noexcept;
  void predict(const KalmanModel& model, double dt_s) noexcept;
  /// False, and nothing changed, when the innovation's covariance cannot be inverted.
  bool update(const KalmanModel& model, const std::array<double, 3>& position, const Block3& noise) noexcept;
  /// Takes the position and keeps all else: for a measurement at an unknown time.
  void replace_position(const std::array<double, 3>& position, const Block3& noise) noexcept;
};

Block3 full(const Covariance& upper) noexcept;  ///< from xx, xy, xz, yy, yz, zz
Covariance upper(const Block3& symmetric) noexcept;
/// False when not positive definite.
bool invert_symmetric(const Block3& a, Block3& inverse) noexcept;
/// dᵀ a⁻¹ d, or infinity where `a` cannot be inverted.
double mahalanobis2(const std::array<double, 3>& d, const Block3& a) noexcept;

}  // namespace rptv
