// SPDX-License-Identifier: MIT
// From grey values to candidates: lit pixels, rays, counting and classification, by the CPU or a device.
#pragma once

#include <optional>

#include "reconstruct/light_field/classify_dbscan.hpp"
#include "reconstruct/light_field/coarse_maxima.hpp"
#include "reconstruct/light_field/light_field_device.hpp"
#include "reconstruct/light_field/light_field_settings.hpp"

namespace rptv {

/// Nothing allocates after construction; one thread calls, `settings.threads` work. What a device does is the same bit
/// for bit; when it fails, the CPU takes over at that step.
class CandidateSearch {
 public:
  /// The references must outlive this. `make_device` may be null.
  CandidateSearch(const LightFieldSettings& settings, const LightFieldDevicePlan& plan, std::uint16_t min_count,
                  const MakeLightFieldDevice& make_device);

  /// Reconstructor::page_lock().
  bool page_lock(std::span<std::byte> memory) noexcept { return device_ == nullptr || device_->page_lock(memory); }
  /// Begins with a frame on the device, from grey values to particles, where there is one that can; collect() waits for
  /// the first that was begun with, and is false when the device has failed. At most kDeviceFrames at a time.
  bool submit(const ImageView& image, const DarkLimit& limit, bool changed) noexcept;
  bool collect(DeviceFrame& frame) noexcept;
  bool does_frames() const noexcept { return device_ != nullptr && claim_; }
  /// The rays of the frame that was collected last, for find(); false when the device has failed.
  bool read_rays(Rays& rays) noexcept { return device_ != nullptr && by_device(device_->read_rays(rays)); }
  /// find_lit_pixels(). `changed`: the limits are not those of the last call.
  std::size_t find_lit(const ImageView& image, const DarkLimit& limit, bool changed,
                       std::span<std::uint32_t> lit) noexcept;
  /// Rays of lit pixels, eq. (5); returns how many pixels were left out. With a device they stay there, and `rays`
  /// gets their number only.
  std::size_t find_rays(std::span<const std::uint32_t> lit, Rays& rays) noexcept;
  /// All particles that the rays of the last find_rays() show, when a device can tell: then true. Otherwise they are
  /// for find() to explain, and `rays` gets the rest of them.
  bool find_particles(Rays& rays, DeviceParticles& particles) noexcept;
  /// Candidates from the free rays of the last find_rays(), eq. (6) and (7); valid until the next call. In a frame's
  /// first round the density of its cloud decides how it is classified, if that is automatic.
  std::span<const Candidate> find(const Rays& rays, std::span<const std::uint8_t> taken, bool first_round) noexcept;

  std::size_t refused() const noexcept { return refused_; }        ///< by the last find(): without room
  bool has_device() const noexcept { return device_ != nullptr; }  ///< one that has not failed
  bool device_failed() const noexcept { return device_failed_; }   ///< ever

 private:
  bool by_device(bool done) noexcept;
  bool tell(const DarkLimit& limit, bool changed) noexcept;
  bool cloud_is_dense() const noexcept;

  const PixelsToRays& pixels_to_rays_;
  const VoxelGrid grid_;
  const std::uint16_t min_count_;
  const std::size_t rounds_;
  const bool claim_;
  const std::string classification_;
  const double density_limit_;
  const std::array<std::int32_t, 3> maximum_half_width_;
  RayCounter counter_;
  std::optional<CoarseMaxima> coarse_maxima_;  // or else cloud and dbscan
  VoxelCloud cloud_;
  Dbscan dbscan_;
  std::vector<Candidate> candidates_;
  std::unique_ptr<LightFieldDevice> device_;
  std::span<const std::uint32_t> converted_;  // by the last find_rays()
  bool dense_ = true;                         // the first round decides for the frame
  bool device_failed_ = false, device_has_limit_ = false;
  std::size_t refused_ = 0;
};

}  // namespace rptv
