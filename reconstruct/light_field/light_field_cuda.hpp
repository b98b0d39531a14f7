// SPDX-License-Identifier: MIT
// The light-field steps on a CUDA device, for two frames at a time.
#pragma once

#include <array>

#include "reconstruct/cuda_page_lock.hpp"
#include "reconstruct/light_field/light_field_slot_cuda.hpp"

namespace rptv {

/// On the device that is current when it is made. Copies of one frame run beside the kernels of the other.
class LightFieldCuda final : public LightFieldDevice {
 public:
  /// Throws Error(unavailable) when the device has not enough memory. `graph`: see LightFieldSlot.
  explicit LightFieldCuda(const LightFieldDevicePlan& plan, bool graph = true);

  bool page_lock(std::span<std::byte> memory) noexcept override;
  bool set_limit(const DarkLimit& limit) noexcept override;
  bool find_lit_pixels(const ImageView& image, std::span<std::uint32_t> lit, std::size_t& found) noexcept override;
  bool find_rays(std::span<const std::uint32_t> lit, Rays& rays, std::size_t& refused) noexcept override;
  bool read_rays(Rays& rays) noexcept override;
  bool find_particles(std::uint16_t least, std::size_t rounds, DeviceParticles& particles) noexcept override;
  bool find_candidates(std::span<const std::uint8_t> taken, std::uint16_t least, std::vector<Candidate>& candidates,
                       std::size_t& refused) noexcept override;
  bool submit(const ImageView& image, std::uint16_t least, std::size_t rounds) noexcept override;
  bool collect(DeviceFrame& frame) noexcept override;

 private:
  bool tell_limit(std::size_t slot) noexcept;
  /// The slot of the frame that was collected last, for what else is asked about it.
  std::size_t last() const noexcept { return (collected_ + kDeviceFrames - 1) % kDeviceFrames; }

  const LightFieldTables tables_;
  std::array<LightFieldSlot, kDeviceFrames> slots_;
  const DarkLimit* limit_ = nullptr;
  std::array<bool, kDeviceFrames> knows_limit_{};
  std::size_t submitted_ = 0, collected_ = 0;
  std::vector<CudaPageLock> page_locks_;
};

/// The same as a MakeLightFieldDevice; in a build without CUDA it throws Error(unavailable).
std::unique_ptr<LightFieldDevice> make_light_field_cuda(const LightFieldDevicePlan& plan);

}  // namespace rptv
