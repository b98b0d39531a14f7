// SPDX-License-Identifier: MIT
// Particles fitted to the grey values themselves: the light-field form of shaking (Wieneke 2013, Schanz et al. 2016).
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "core/image.hpp"
#include "reconstruct/light_field/lenslet_misfit.hpp"
#include "reconstruct/light_field/particle_image.hpp"
#include "reconstruct/light_field/shake_options.hpp"
#include "reconstruct/light_field/shake_step.hpp"

namespace rptv {

/// Each particle in turn is fitted (Levenberg-Marquardt, shot-noise weights) to what the others leave of the image. The
/// sensor is cut into stripes wider than a particle's image; every other stripe at a time is worked on, so that
/// neighbours never change under each other, and the result does not depend on the number of threads. Nothing allocates
/// after construction; one thread calls.
class Shake {
 public:
  /// Throws Error(configuration) without a pupil radius.
  Shake(const LightFieldCalibration& calibration, const LensletLattice& lattice, const ShakeOptions& options);

  /// Starts a frame with no particles. `background`: grey values without light, one per pixel. Both must stay until the
  /// last call for this frame.
  void begin(const ImageView& image, std::span<const float> background) noexcept;
  /// Fits particles[0 … n) to the image, moved in place; `first_new` and later are new since the last call. Those that
  /// turn out to be ghosts, or leave the volume, are taken out. Returns how many are left, in unchanged order.
  std::size_t refine(std::span<FittedParticle> particles, std::size_t first_new) noexcept;
  /// Of particles whose places and lights are known, those become one of which one explains all but so little χ² as
  /// noise does. The first call of a frame. Returns how many are left.
  std::size_t unite(std::span<FittedParticle> particles) noexcept;
  /// What refine() tells about particles, of such as are placed already: ghosts are taken out. The first call, too.
  std::size_t describe(std::span<FittedParticle> particles) noexcept;
  /// Light of pixels, grey values above background: what particles explain (not below 0, but for rounding); the rest.
  std::span<const float> explained() const noexcept { return explained_; }
  float unexplained(std::uint32_t pixel) const noexcept { return grey(pixel) - explained_[pixel]; }

 private:
  struct Worker {
    Worker(const ImageModel& m, const LensletMisfit& d, std::size_t max_pixels)
        : model(m), disagreement(d), now(max_pixels), next(max_pixels), grey(max_pixels), others(max_pixels) {}
    ImageModel model;
    LensletMisfit disagreement;
    ParticleImage now, next;
    std::vector<float> grey, others;
  };
  float grey(std::uint32_t pixel) const noexcept {
    return (image_.shape.bytes_per_pixel == 1 ? static_cast<float>(image_.as_u8()[pixel])
                                              : static_cast<float>(image_.as_u16()[pixel])) -
           background_[pixel];
  }
  struct State {
    FittedParticle particle;
    ShakeSums sums;
  };
  Seen look(const ParticleImage& image, Worker& worker) const noexcept;
  void paint(const ParticleImage& image, double light) noexcept;
  void sort_into_stripes(std::span<const FittedParticle> particles) noexcept;
  void for_each(std::span<FittedParticle> particles, const auto& visit) noexcept;
  void introduce(FittedParticle& particle, Worker& worker) noexcept;
  void fit(FittedParticle& particle, Worker& worker, bool search) noexcept;
  bool render(State& state, ParticleImage& image, Worker& worker) const noexcept;
  void weigh(State& state, const ParticleImage& image, Worker& worker) const noexcept;
  void climb(State& state, Worker& worker, int steps) const noexcept;
  void tell(const State& state, Worker& worker, FittedParticle& particle) const noexcept;
  void search_depth(State& state, Worker& worker) const noexcept;
  bool may_be_one(const FittedParticle& a, const FittedParticle& b) const noexcept;
  bool same_place(const FittedParticle& a, const FittedParticle& b) const noexcept;
  void join_halves(std::span<FittedParticle> particles) noexcept;
  void paint_all(std::span<FittedParticle> particles) noexcept;
  void join_twins(std::span<FittedParticle> particles) noexcept;
  bool join(FittedParticle& one, FittedParticle& other, Worker& worker) noexcept;
  double crowded(const State& state, const Worker& worker) const noexcept;
  ShakeSums paint_and_weigh(const FittedParticle& particle, Worker& worker) noexcept;
  void drop_middles(std::span<FittedParticle> particles) noexcept;
  bool explain_without(FittedParticle& middle, std::span<FittedParticle* const> around) noexcept;
  void paint_again(const FittedParticle& particle, double share, Worker& worker) noexcept;
  bool is_satellite(const FittedParticle& weak, const FittedParticle& strong) const noexcept;
  void mark_ghosts(std::span<FittedParticle> particles) noexcept;
  std::size_t drop_ghosts(std::span<FittedParticle> particles) noexcept;

  const ShakeOptions options_;
  const std::uint32_t width_px_;
  const ChiefRay column_of_;
  ImageView image_{};
  std::span<const float> background_;
  std::vector<float> explained_;       // light of all particles, grey values
  std::vector<std::uint8_t> painted_;  // blocks of explained_ that are not all 0
  std::vector<Worker> workers_;
  std::size_t stripes_ = 1;
  double stripe_px_ = 0;
  std::vector<std::uint32_t> order_, stripe_first_;  // particles by stripe
  float misfit_ = 0;                                 // rms error of the model of others' images, as a share
  std::vector<float> lights_;                        // workspace
};

}  // namespace rptv
