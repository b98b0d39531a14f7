// SPDX-License-Identifier: MIT
// What a GPU may do of the light-field chain: everything that is per pixel, per ray or per voxel.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "core/image.hpp"
#include "reconstruct/light_field/explain_away.hpp"
#include "reconstruct/light_field/pixels_to_rays.hpp"
#include "reconstruct/light_field/voxel_cloud.hpp"
#include "reconstruct/lit_pixels.hpp"

namespace rptv {

/// All particles of a set of rays, and how they were found.
struct DeviceParticles {
  std::vector<FittedParticle> found;  ///< of ExplainOptions::max_particles, which are reserved
  bool sure = false;                  ///< false: `found` is empty, and the CPU has to explain the rays
  std::size_t rounds = 0, candidates = 0, refused_candidates = 0;  ///< in all rounds
};

/// What a whole frame gives.
struct DeviceFrame {
  std::size_t lit_pixels = 0;        ///< found, as by find_lit_pixels()
  std::size_t rays = 0, pixels = 0;  ///< Rays::size and Rays::pixels
  DeviceParticles particles;
};

constexpr std::size_t kDeviceFrames = 2;  ///< that may be submitted and not collected

/// The steps of LightField on another processor, with the same results bit for bit. Set-up takes all memory. One
/// thread calls; every call but submit() returns when it is done, and is false when the device fails: LightField then
/// goes on with the CPU and does not ask again.
class LightFieldDevice {
 public:
  virtual ~LightFieldDevice() = default;

  /// Reconstructor::page_lock().
  virtual bool page_lock(std::span<std::byte> memory) noexcept = 0;
  /// The limits of the images to come, of as many pixels; they stay as they are until the next call.
  virtual bool set_limit(const DarkLimit& limit) noexcept = 0;
  /// find_lit_pixels() with those limits; `found` becomes what it returns.
  virtual bool find_lit_pixels(const ImageView& image, std::span<std::uint32_t> lit, std::size_t& found) noexcept = 0;
  /// PixelsToRays::convert(), for the steps below; `refused` becomes what it returns, and only `size` and `pixels` of
  /// `rays` are set. `lit` is what find_lit_pixels() gave, or part of it.
  virtual bool find_rays(std::span<const std::uint32_t> lit, Rays& rays, std::size_t& refused) noexcept = 0;
  /// The rest of `rays`, whose `size` and `pixels` are known.
  virtual bool read_rays(Rays& rays) noexcept = 0;
  /// Up to `rounds` of candidates (as find_candidates()) and ExplainAway::explain(), then settle().
  virtual bool find_particles(std::uint16_t least, std::size_t rounds, DeviceParticles& particles) noexcept = 0;
  /// RayCounter::count() with the rays of the last find_rays(), and CoarseMaxima::find(); `refused` becomes what it
  /// returns. `taken` has a value for each ray.
  virtual bool find_candidates(std::span<const std::uint8_t> taken, std::uint16_t least,
                               std::vector<Candidate>& candidates, std::size_t& refused) noexcept = 0;

  /// Begins with a frame: lit pixels, rays and find_particles(). The image is left alone until it is collected.
  virtual bool submit(const ImageView& image, std::uint16_t least, std::size_t rounds) noexcept = 0;
  /// Waits for the frame that was submitted first; read_rays() and find_candidates() then go on with its rays.
  virtual bool collect(DeviceFrame& frame) noexcept = 0;
};

/// What a device is set up for; the references live as long as it does.
struct LightFieldDevicePlan {
  const ImageShape& shape;
  const LensletLattice& lattice;
  const PixelsToRays& pixels_to_rays;
  const VoxelGrid& grid;
  const RayWindow& window;
  const ExplainOptions& explain;
  std::size_t max_rays, max_candidates;
  std::size_t threads;  ///< that the CPU would take
};

/// Throws Error(unavailable) when the device cannot be used.
using MakeLightFieldDevice = std::function<std::unique_ptr<LightFieldDevice>(const LightFieldDevicePlan&)>;

}  // namespace rptv
