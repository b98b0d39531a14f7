// SPDX-License-Identifier: MIT
// Frames by turns to two slots.
#include "reconstruct/light_field/light_field_cuda.hpp"

namespace rptv {

LightFieldCuda::LightFieldCuda(const LightFieldDevicePlan& plan, bool graph)
    : tables_(plan), slots_{LightFieldSlot(plan, tables_, graph), LightFieldSlot(plan, tables_, graph)} {}

bool LightFieldCuda::page_lock(std::span<std::byte> memory) noexcept {
  CudaPageLock lock(memory.data(), memory.size());
  if (!lock.locked()) return false;
  page_locks_.push_back(std::move(lock));
  return true;
}

bool LightFieldCuda::set_limit(const DarkLimit& limit) noexcept {
  limit_ = &limit;
  knows_limit_ = {};
  return true;
}

bool LightFieldCuda::tell_limit(std::size_t slot) noexcept {
  if (knows_limit_[slot]) return true;
  knows_limit_[slot] = limit_ != nullptr && slots_[slot].set_limit(*limit_);
  return knows_limit_[slot];
}

bool LightFieldCuda::find_lit_pixels(const ImageView& image, std::span<std::uint32_t> lit,
                                     std::size_t& found) noexcept {
  return tell_limit(last()) && slots_[last()].find_lit_pixels(image, lit, found);
}

bool LightFieldCuda::find_rays(std::span<const std::uint32_t> lit, Rays& rays, std::size_t& refused) noexcept {
  return slots_[last()].find_rays(lit, rays, refused);
}

bool LightFieldCuda::read_rays(Rays& rays) noexcept { return slots_[last()].read_rays(rays); }

bool LightFieldCuda::find_particles(std::uint16_t least, std::size_t rounds, DeviceParticles& particles) noexcept {
  return slots_[last()].find_particles(least, rounds, particles);
}

bool LightFieldCuda::find_candidates(std::span<const std::uint8_t> taken, std::uint16_t least,
                                     std::vector<Candidate>& candidates, std::size_t& refused) noexcept {
  return slots_[last()].find_candidates(taken, least, candidates, refused);
}

bool LightFieldCuda::submit(const ImageView& image, std::uint16_t least, std::size_t rounds) noexcept {
  const std::size_t slot = submitted_ % kDeviceFrames;
  if (submitted_ - collected_ == kDeviceFrames || !tell_limit(slot) || !slots_[slot].submit(image, least, rounds))
    return false;
  ++submitted_;
  return true;
}

bool LightFieldCuda::collect(DeviceFrame& frame) noexcept {
  return collected_ < submitted_ && slots_[collected_++ % kDeviceFrames].collect(frame);
}

std::unique_ptr<LightFieldDevice> make_light_field_cuda(const LightFieldDevicePlan& plan) {
  return std::make_unique<LightFieldCuda>(plan);
}

}  // namespace rptv
