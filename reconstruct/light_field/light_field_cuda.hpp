// SPDX-License-Identifier: MIT
// The light-field steps on a CUDA device: its memory, and the order of the kernels.
#pragma once

#include <array>

#include "reconstruct/cuda_memory.hpp"
#include "reconstruct/cuda_page_lock.hpp"
#include "reconstruct/light_field/coarse_maxima_cuda.hpp"
#include "reconstruct/light_field/explainer_cuda.hpp"
#include "reconstruct/light_field/light_field_device.hpp"
#include "reconstruct/light_field/pixels_to_rays_cuda.hpp"
#include "reconstruct/light_field/ray_count_cuda.hpp"

namespace rptv {

/// On the device that is current when it is made. One stream; nothing is allocated after construction.
class LightFieldCuda final : public LightFieldDevice {
 public:
  /// Throws Error(unavailable) when the device has not enough memory.
  explicit LightFieldCuda(const LightFieldDevicePlan& plan);

  bool page_lock(std::span<std::byte> memory) noexcept override;
  bool set_limit(const DarkLimit& limit) noexcept override;
  bool find_lit_pixels(const ImageView& image, std::span<std::uint32_t> lit, std::size_t& found) noexcept override;
  bool find_rays(std::span<const std::uint32_t> lit, Rays& rays, std::size_t& refused) noexcept override;
  bool read_rays(Rays& rays) noexcept override;
  bool find_particles(std::uint16_t least, std::size_t rounds, DeviceParticles& particles) noexcept override;
  bool find_candidates(std::span<const std::uint8_t> taken, std::uint16_t least, std::vector<Candidate>& candidates,
                       std::size_t& refused) noexcept override;

 private:
  bool tell_candidates() noexcept;
  bool queue_candidates(const std::uint8_t* taken, std::uint16_t least) noexcept;

  const VoxelGrid grid_;
  CudaStream stream_;
  /// Sizes that kernels find: lit pixels, rays, pixels with rays, candidates.
  enum Size : std::size_t { kLit, kRays, kPixels, kCandidates, kSizes };
  DeviceArray<std::uint32_t> sizes_;
  PinnedArray<std::uint32_t> found_;

  DeviceArray<std::uint16_t> image_, limit_;
  DeviceArray<std::uint32_t> lit_, pixel_runs_, table_;
  DeviceArray<float> centres_;
  DeviceArray<Ray> ray_;
  DeviceArray<std::uint32_t> pixel_, same_pixel_, first_of_lenslet_;
  DeviceArray<std::uint32_t> sort_first_ray_, sort_place_, sort_pixel_, sort_lenslet_, sort_filled_;
  DeviceArray<std::uint8_t> taken_;
  DeviceArray<VoxelRay> voxel_rays_;
  DeviceArray<RayChunk> chunks_;
  DeviceArray<std::uint16_t> counts_, smooth_, highest_;
  DeviceArray<std::uint32_t> voxel_runs_;
  DeviceArray<Candidate> candidate_;
  PinnedArray<std::uint16_t> watched_counts_;  // where a StageTimer watches

  const CudaLitPixels lit_pixels_;
  const CudaRayTable ray_table_;
  const CudaRaySort ray_sort_;
  const CudaRays rays_;
  const CudaRayCount ray_count_;
  const CudaCandidates candidates_;
  ExplainerCuda explainer_;
  bool uniform_limit_ = true;
  std::vector<CudaPageLock> page_locks_;
};

/// The same as a MakeLightFieldDevice; in a build without CUDA it throws Error(unavailable).
std::unique_ptr<LightFieldDevice> make_light_field_cuda(const LightFieldDevicePlan& plan);

}  // namespace rptv
