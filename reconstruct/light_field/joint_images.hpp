// SPDX-License-Identifier: MIT
// The images of all particles of a frame side by side, as a fit of all together needs them.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "reconstruct/light_field/particle_image.hpp"

namespace rptv {

/// A particle that is fitted together with the others.
struct JointParticle {
  ImagePoint at;
  double light = 0;  ///< grey values in all
};

/// Room for the images of one set of particles. Nothing allocates after construction.
class JointImages {
 public:
  struct Image {
    std::uint32_t first = 0, count = 0;
  };
  /// `max_entries`: pixels of all images together.
  JointImages(std::size_t max_particles, std::size_t max_entries)
      : images_(max_particles),
        pixel_(max_entries),
        value_(max_entries),
        dx_(max_entries),
        dy_(max_entries),
        dz_(max_entries) {}

  /// Starts a set of `particles` images, all empty.
  void begin(std::size_t particles) noexcept;
  /// Stores an image of particle k; false, and no image, when there is no room. Any thread, each k once.
  bool put(std::size_t k, const ParticleImage& image) noexcept;
  /// The same from another set.
  bool copy(std::size_t k, const JointImages& from) noexcept;

  std::size_t particles() const noexcept { return count_; }
  std::size_t entries() const noexcept { return end_.load(std::memory_order_relaxed); }
  const Image& image(std::size_t k) const noexcept { return images_[k]; }
  const std::uint32_t* pixel() const noexcept { return pixel_.data(); }
  const float* value() const noexcept { return value_.data(); }
  const float* dx() const noexcept { return dx_.data(); }
  const float* dy() const noexcept { return dy_.data(); }
  const float* dz() const noexcept { return dz_.data(); }

  /// Adds the light of particle k to an image of the sensor.
  void paint(std::size_t k, double light, std::span<float> sensor) const noexcept;

 private:
  bool take_room(std::size_t k, std::size_t pixels) noexcept;

  std::vector<Image> images_;
  std::vector<std::uint32_t> pixel_;
  std::vector<float> value_, dx_, dy_, dz_;
  std::size_t count_ = 0;
  std::atomic<std::size_t> end_{0};
};

}  // namespace rptv
