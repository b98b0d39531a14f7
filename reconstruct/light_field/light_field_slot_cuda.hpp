// SPDX-License-Identifier: MIT
// One light-field frame on a CUDA device: its memory, and the order of the kernels.
#pragma once

#include "reconstruct/cuda_graph.hpp"
#include "reconstruct/cuda_memory.hpp"
#include "reconstruct/light_field/coarse_maxima_cuda.hpp"
#include "reconstruct/light_field/explainer_cuda.hpp"
#include "reconstruct/light_field/light_field_device.hpp"
#include "reconstruct/light_field/pixels_to_rays_cuda.hpp"
#include "reconstruct/light_field/ray_count_cuda.hpp"

namespace rptv {

/// What all frames share, on the device.
struct LightFieldTables {
  /// Throws Error(unavailable), as all of this file, when the device has not enough memory.
  explicit LightFieldTables(const LightFieldDevicePlan& plan);
  DeviceArray<std::uint32_t> lenslets;
  DeviceArray<float> centres_mm;
};

/// One stream, and memory for one frame; nothing is allocated after construction, but for a graph, when a frame is the
/// first, or other than the last one in what the device was told about it.
class LightFieldSlot {
 public:
  /// `plan.explain` and `tables` outlive this. Without `graph`, the kernels are queued one by one for each frame.
  LightFieldSlot(const LightFieldDevicePlan& plan, const LightFieldTables& tables, bool graph);

  // As LightFieldDevice's.
  bool set_limit(const DarkLimit& limit) noexcept;
  bool find_lit_pixels(const ImageView& image, std::span<std::uint32_t> lit, std::size_t& found) noexcept;
  bool find_rays(std::span<const std::uint32_t> lit, Rays& rays, std::size_t& refused) noexcept;
  bool read_rays(Rays& rays) noexcept;
  bool find_particles(std::uint16_t least, std::size_t rounds, DeviceParticles& particles) noexcept;
  bool find_candidates(std::span<const std::uint8_t> taken, std::uint16_t least, std::vector<Candidate>& candidates,
                       std::size_t& refused) noexcept;
  bool submit(const ImageView& image, std::uint16_t least, std::size_t rounds) noexcept;
  bool collect(DeviceFrame& frame) noexcept;

 private:
  /// What a recorded frame is bound to.
  struct Frame {
    ImageShape shape;
    bool uniform_limit = true;
    std::uint16_t least = 0;
    std::size_t rounds = 0;
    bool operator==(const Frame&) const = default;
  };
  bool queue_lit_pixels(const ImageShape& shape) noexcept;
  bool queue_frame(const Frame& frame) noexcept;
  bool tell_candidates() noexcept;
  void tell_rays(std::size_t lit) noexcept;
  bool queue_candidates(const std::uint8_t* taken, std::uint16_t least) noexcept;

  const VoxelGrid grid_;
  CudaStream stream_;
  /// Sizes that kernels find: lit pixels, rays, pixels with rays, candidates.
  enum Size : std::size_t { kLit, kRays, kPixels, kCandidates, kSizes };
  DeviceArray<std::uint32_t> sizes_;
  PinnedArray<std::uint32_t> found_;

  DeviceArray<std::uint16_t> image_, limit_;
  DeviceArray<std::uint32_t> lit_, pixel_runs_;
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
  const bool graph_;
  bool uniform_limit_ = true;
  Frame frame_;           // that was submitted last
  Frame recorded_frame_;  // that the graph is for
  CudaGraph recorded_;
};

}  // namespace rptv
