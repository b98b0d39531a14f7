// SPDX-License-Identifier: MIT
// Smoothing makes errors smaller, and promises the errors that are left.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "core/error.hpp"
#include "tests/tracking/linking.hpp"
#include "tests/tracking/simulated_motion.hpp"
#include "tracking/smoother.hpp"

namespace rptv {
namespace {

constexpr double kPeriodS = 0.01;
constexpr std::size_t kParticles = 60;
constexpr std::size_t kFrames = 30;

/// Particles far apart that move as the filter of these settings believes; model error 0.3 mm a frame.
struct Motions {
  explicit Motions(const char* predict) {
    settings = settings_for(15, 5, predict);
    settings.model_error_mm = 0.3;
    model.order = std::string(predict) == "kalman" ? 2 : 3;
    model.acceleration_mm_s2 = 2 * settings.model_error_mm / (kPeriodS * kPeriodS);
    model.velocity_prior_mm_s = 1 / kPeriodS;
    for (unsigned i = 0; i < kParticles; ++i) {
      particles.emplace_back(model, i);
      particles.back().x[0] = {1000.0 * i, 0, 0};
    }
  }
  LinkerSettings settings;
  KalmanModel model;
  std::vector<SimulatedMotion> particles;
};

struct Outcome {
  double rms_filtered = 0, rms_smoothed = 0, nees_position = 0, nees_velocity = 0;
};

double nees(const std::array<double, 3>& e, const Covariance& c) { return mahalanobis2(e, full(c)); }

Outcome run(const char* predict, std::size_t lag) {
  Motions motions(predict);
  Linker linker(motions.settings);
  Tracks tracks(linker.capacity());
  FixedLagSmoother smoother(lag);
  std::vector<std::vector<SimulatedMotion>> truth;
  std::vector<Tracks> filtered;
  std::vector<SmoothedFrame> smoothed;
  SmoothedFrame out;
  for (std::size_t frame = 0; frame < kFrames; ++frame) {
    Particles particles(kParticles);
    for (std::size_t i = 0; i < kParticles; ++i) {
      if (frame > 0) motions.particles[i].move(kPeriodS);
      const auto z = motions.particles[i].measured();
      particles.push({z[0], z[1], z[2], 0, 0, kNoise});
    }
    truth.push_back(motions.particles);
    linker.next(particles, frame, static_cast<std::int64_t>(frame) * kPeriodNs, tracks);
    EXPECT_EQ(linker.counters().births, kParticles);
    filtered.push_back(tracks);
    smoother.push(linker, frame, static_cast<double>(frame) * kPeriodS, tracks);
    while (smoother.pop(out)) smoothed.push_back(out);
    EXPECT_EQ(smoothed.size(), frame < lag ? 0 : frame - lag + 1);
  }
  while (smoother.pop(out, true)) smoothed.push_back(out);
  EXPECT_EQ(smoothed.size(), kFrames);
  Outcome outcome;
  double count = 0;
  for (std::size_t frame = 5; frame + lag + 1 < kFrames; ++frame)
    for (std::size_t i = 0; i < kParticles; ++i, ++count) {
      const auto& x = truth[frame][i].x;
      const Tracks& s = smoothed[frame].tracks;
      const std::array<double, 3> e{s.x_mm[i] - x[0][0], s.y_mm[i] - x[0][1], s.z_mm[i] - x[0][2]};
      const std::array<double, 3> ev{s.vx_mm_s[i] - x[1][0], s.vy_mm_s[i] - x[1][1], s.vz_mm_s[i] - x[1][2]};
      const double ef = filtered[frame].x_mm[i] - x[0][0];
      outcome.rms_filtered += ef * ef;
      outcome.rms_smoothed += e[0] * e[0];
      outcome.nees_position += nees(e, s.estimate[i].position_mm2);
      outcome.nees_velocity += nees(ev, s.estimate[i].velocity_mm2_s2);
    }
  outcome.rms_filtered = std::sqrt(outcome.rms_filtered / count);
  outcome.rms_smoothed = std::sqrt(outcome.rms_smoothed / count);
  outcome.nees_position /= count;
  outcome.nees_velocity /= count;
  return outcome;
}

TEST(Smoother, makes_positions_better_and_says_how_good_they_are) {
  for (const char* predict : {"kalman", "kalman_acceleration"}) {
    const Outcome outcome = run(predict, 5);
    EXPECT_LT(outcome.rms_smoothed, 0.95 * outcome.rms_filtered) << predict;
    // 3 states each; frames near each other are correlated, so that the mean is looser than of independent runs.
    EXPECT_NEAR(outcome.nees_position, 3, 0.35) << predict;
    EXPECT_NEAR(outcome.nees_velocity, 3, 0.35) << predict;
  }
}

TEST(Smoother, changes_nothing_without_a_lag) {
  const Outcome outcome = run("kalman", 0);
  EXPECT_EQ(outcome.rms_smoothed, outcome.rms_filtered);
}

TEST(Smoother, follows_tracks_across_frames_in_which_they_were_unseen) {
  LinkerSettings settings = settings_for(1, 3, "kalman");
  settings.model_error_mm = settings.noise_mm = 0.001;
  Linker linker(settings);
  Tracks tracks(linker.capacity());
  FixedLagSmoother smoother(20);
  for (std::uint64_t frame = 0; frame < 12; ++frame) {
    const Positions3 at =
        frame == 5 || frame == 6 ? Positions3{} : Positions3{{0.1 * static_cast<double>(frame), 0, 0}};
    linker.next(particles_at(at), frame, static_cast<std::int64_t>(frame) * kPeriodNs, tracks);
    smoother.push(linker, frame, static_cast<double>(frame) * kPeriodS, tracks);
  }
  EXPECT_EQ(linker.counters().births, 1U);
  SmoothedFrame out;
  ASSERT_TRUE(smoother.pop(out, true));
  EXPECT_NEAR(out.tracks.vx_mm_s[0], 10, 0.1) << "the first frame knows the velocity from later ones";
  std::size_t frames = 1;
  while (smoother.pop(out, true)) ++frames;
  EXPECT_EQ(frames, 12U);
}

TEST(Smoother, needs_a_filter) {
  Session session(settings_for(1));
  session.next({{0, 0, 0}});
  FixedLagSmoother smoother(2);
  EXPECT_THROW(smoother.push(session.linker, 0, 0, session.tracks), Error);
}

}  // namespace
}  // namespace rptv
