// SPDX-License-Identifier: MIT
// Copies and kernels of one light-field frame, in order on one stream.
#include "reconstruct/light_field/light_field_slot_cuda.hpp"

#include <algorithm>
#include <numeric>

#include "core/error.hpp"
#include "reconstruct/cuda_scan.hpp"
#include "reconstruct/cuda_stage_timer.hpp"

namespace rptv {

namespace {

// Of candidates in a frame's rounds, when they are queued without waiting: what particles beside each other take. Where
// more are needed, the frame is explained again, with as many as it takes.
constexpr int kFirstTurns = 32, kLaterTurns = 8;

std::size_t voxels_of(const VoxelGrid& grid) {
  return static_cast<std::size_t>(grid.plane_size()) * static_cast<std::size_t>(grid.planes);
}

[[noreturn]] void refuse_copies() {
  throw Error(ExitCode::unavailable,
              "CUDA: cannot copy to the device: " + take_cuda_error() + "; take reconstruction.backend = \"cpu\"");
}

std::uint32_t u32(std::size_t value) noexcept { return static_cast<std::uint32_t>(value); }

}  // namespace

LightFieldTables::LightFieldTables(const LightFieldDevicePlan& plan)
    : lenslets(plan.pixels_to_rays.lenslets().size()), centres_mm(2 * plan.lattice.size()) {
  std::vector<float> centres;
  for (std::uint32_t l = 0; l < plan.lattice.size(); ++l)
    for (const float at : plan.lattice.centre_mm(l)) centres.push_back(at);
  const auto& table = plan.pixels_to_rays.lenslets();
  CudaStream stream;
  if (!stream.upload(lenslets.data(), table.data(), table.size_bytes()) ||
      !stream.upload(centres_mm.data(), centres.data(), centres.size() * sizeof(float)) || !stream.synchronize())
    refuse_copies();
}

LightFieldSlot::LightFieldSlot(const LightFieldDevicePlan& plan, const LightFieldTables& tables, bool graph)
    : grid_(plan.grid),
      sizes_(kSizes),
      found_(kSizes),
      image_(plan.shape.pixels()),
      limit_(plan.shape.pixels()),
      lit_(plan.max_rays),
      pixel_runs_(compact_runs(plan.shape.pixels())),
      ray_(plan.max_rays),
      pixel_(plan.max_rays),
      same_pixel_(plan.max_rays),
      first_of_lenslet_(plan.lattice.size() + 1),
      sort_first_ray_(plan.max_rays),
      sort_place_(plan.max_rays),
      sort_pixel_(plan.max_rays),
      sort_lenslet_(plan.max_rays),
      sort_filled_(plan.lattice.size()),
      taken_(plan.max_rays),
      voxel_rays_(ray_chunks(plan.max_rays) * RayChunk::kRays),
      chunks_(ray_chunks(plan.max_rays)),
      counts_(voxels_of(grid_)),
      smooth_(voxels_of(grid_)),
      highest_(voxels_of(grid_)),
      voxel_runs_(compact_runs(voxels_of(grid_))),
      candidate_(plan.max_candidates),
      watched_counts_(stream_.watched() ? voxels_of(grid_) : 0),
      lit_pixels_{lit_.data(), sizes_.data() + kLit, pixel_runs_.data(), u32(plan.max_rays)},
      ray_table_{tables.lenslets.data(), tables.centres_mm.data(), plan.pixels_to_rays.optics(),
                 u32(plan.pixels_to_rays.hypotheses()), plan.pixels_to_rays.width_px()},
      ray_sort_{sort_first_ray_.data(), sort_place_.data(), sort_pixel_.data(), sort_lenslet_.data(),
                sort_filled_.data()},
      rays_{ray_.data(),           pixel_.data(),           same_pixel_.data(), first_of_lenslet_.data(),
            sizes_.data() + kRays, sizes_.data() + kPixels, u32(plan.max_rays), u32(plan.lattice.size())},
      ray_count_{voxel_rays_.data(), chunks_.data(), counts_.data()},
      candidates_{candidate_.data(), sizes_.data() + kCandidates, u32(plan.max_candidates), smooth_.data(),
                  highest_.data(),   voxel_runs_.data()},
      explainer_(plan, rays_, candidates_),
      graph_(graph) {
  if (!stream_.fill(sizes_.data(), 0, kSizes * sizeof(std::uint32_t)) || !stream_.synchronize()) refuse_copies();
}

bool LightFieldSlot::set_limit(const DarkLimit& limit) noexcept {
  uniform_limit_ = limit.uniform();
  const std::size_t count = uniform_limit_ ? 1 : limit.size();
  return limit.size() == limit_.size() &&
         stream_.upload(limit_.data(), limit.limits().data(), count * sizeof(std::uint16_t)) && stream_.synchronize();
}

bool LightFieldSlot::queue_lit_pixels(const ImageShape& shape) noexcept {
  const CudaImage image{image_.data(), shape.width_px, shape.height_px, shape.bytes_per_pixel};
  return stream_.stage(CudaStage::lit_pixels) &&
         find_lit_pixels_cuda(image, {nullptr, limit_.data(), uniform_limit_}, lit_pixels_, stream_.handle());
}

bool LightFieldSlot::find_lit_pixels(const ImageView& image, std::span<std::uint32_t> lit,
                                     std::size_t& found) noexcept {
  if (image.shape.pixels() != image_.size() || lit.size() < lit_.size()) return false;
  stream_.stage(CudaStage::upload);
  if (!stream_.upload(image_.data(), image.data, image.shape.bytes()) || !queue_lit_pixels(image.shape) ||
      !stream_.stage(CudaStage::download) ||
      !stream_.download(&found_[kLit], lit_pixels_.size, sizeof(std::uint32_t)) || !stream_.stage(CudaStage::none) ||
      !stream_.synchronize())
    return false;
  found = found_[kLit];
  const std::size_t written = std::min(found, lit_.size());
  stream_.tell(CudaStage::lit_pixels, image.shape.bytes() + written * sizeof(std::uint32_t));
  return stream_.stage(CudaStage::download) &&
         stream_.download(lit.data(), lit_.data(), written * sizeof(std::uint32_t)) && stream_.stage(CudaStage::none) &&
         stream_.synchronize();
}

bool LightFieldSlot::find_rays(std::span<const std::uint32_t> lit, Rays& rays, std::size_t& refused) noexcept {
  if (lit.size() > lit_.size() || rays.capacity() < ray_.size()) return false;
  found_[kLit] = u32(lit.size());
  stream_.stage(CudaStage::upload);
  if (!stream_.upload(lit_.data(), lit.data(), lit.size_bytes()) ||
      !stream_.upload(lit_pixels_.size, &found_[kLit], sizeof(std::uint32_t)) || !stream_.stage(CudaStage::rays) ||
      !pixels_to_rays_cuda(lit_pixels_, ray_table_, ray_sort_, rays_, stream_.handle()) ||
      !stream_.stage(CudaStage::download) || !stream_.download(&found_[kRays], rays_.size, 2 * sizeof(std::uint32_t)) ||
      !stream_.stage(CudaStage::none) || !stream_.synchronize())
    return false;
  tell_rays(lit.size());
  refused = lit.size() - found_[kPixels];
  rays.size = found_[kRays], rays.pixels = found_[kPixels];
  return true;
}

// Read: lit pixels. Written: a ray and two indices each, and each lenslet's first. Incremented: a lenslet's number of
// rays, and of those that have a place.
void LightFieldSlot::tell_rays(std::size_t lit) noexcept {
  const std::size_t rays = found_[kRays];
  stream_.tell(CudaStage::rays,
               (lit + 2 * rays + first_of_lenslet_.size()) * sizeof(std::uint32_t) + rays * sizeof(Ray), 2 * rays);
}

bool LightFieldSlot::read_rays(Rays& rays) noexcept {
  auto& first = rays.first_of_lenslet;
  return stream_.stage(CudaStage::download) &&
         stream_.download(rays.ray.data(), ray_.data(), rays.size * sizeof(Ray)) &&
         stream_.download(rays.pixel.data(), pixel_.data(), rays.size * sizeof(std::uint32_t)) &&
         stream_.download(rays.same_pixel.data(), same_pixel_.data(), rays.size * sizeof(std::uint32_t)) &&
         stream_.download(first.data(), first_of_lenslet_.data(), first.size() * sizeof(std::uint32_t)) &&
         stream_.stage(CudaStage::none) && stream_.synchronize();
}

// What a StageTimer is told of the count, an increment a free ray and plane: all counters together, border included.
bool LightFieldSlot::tell_candidates() noexcept {
  if (!stream_.timed()) return true;
  const std::size_t voxels = watched_counts_.size(), voxel_bytes = voxels * sizeof(std::uint16_t);
  if (!stream_.stage(CudaStage::none) ||
      !stream_.download(found_.data(), sizes_.data(), kSizes * sizeof(std::uint32_t)) ||
      !stream_.download(watched_counts_.data(), counts_.data(), voxel_bytes) || !stream_.synchronize())
    return false;
  const std::uint16_t* counts = watched_counts_.data();
  stream_.tell(CudaStage::count, found_[kRays] * (sizeof(Ray) + sizeof(std::uint8_t)) + voxel_bytes,
               std::accumulate(counts, counts + voxels, std::uint64_t{0}));
  stream_.tell(CudaStage::maxima,
               voxel_bytes + std::min<std::size_t>(found_[kCandidates], candidate_.size()) * sizeof(Candidate));
  return true;
}

// Candidates among the rays that are not `taken`, and their number into `found_`.
bool LightFieldSlot::queue_candidates(const std::uint8_t* taken, std::uint16_t least) noexcept {
  return stream_.stage(CudaStage::count) && count_rays_cuda(grid_, rays_, taken, ray_count_, stream_.handle()) &&
         stream_.stage(CudaStage::maxima) &&
         find_coarse_maxima_cuda(grid_, counts_.data(), least, candidates_, stream_.handle()) &&
         stream_.stage(CudaStage::download) &&
         stream_.download(&found_[kCandidates], candidates_.size, sizeof(std::uint32_t)) &&
         stream_.stage(CudaStage::none) && tell_candidates();
}

bool LightFieldSlot::find_particles(std::uint16_t least, std::size_t rounds, DeviceParticles& particles) noexcept {
  if (!stream_.stage(CudaStage::fits) || !explainer_.begin(stream_)) return false;
  for (std::size_t round = 0; round < rounds; ++round) {
    if (!stream_.stage(CudaStage::fits) || !explainer_.begin_round(stream_) ||
        !queue_candidates(explainer_.taken(), least) || !explainer_.explain(stream_))
      return false;
    if (explainer_.accepted() == 0 || !explainer_.sure()) break;
  }
  if (!explainer_.queue_settle(stream_) || !stream_.synchronize()) return false;
  explainer_.read(particles);
  return true;
}

// The frame that is in `image_`, with nothing for the host to decide.
bool LightFieldSlot::queue_frame(const Frame& frame) noexcept {
  bool done = queue_lit_pixels(frame.shape) && stream_.stage(CudaStage::rays) &&
              pixels_to_rays_cuda(lit_pixels_, ray_table_, ray_sort_, rays_, stream_.handle()) &&
              stream_.stage(CudaStage::fits) && explainer_.begin(stream_);
  for (std::size_t round = 0; round < frame.rounds; ++round)
    done = done && stream_.stage(CudaStage::fits) && explainer_.begin_round(stream_) &&
           queue_candidates(explainer_.taken(), frame.least) &&
           explainer_.queue_turns(stream_, round == 0 ? kFirstTurns : kLaterTurns);
  return done && explainer_.queue_settle(stream_) &&
         stream_.download(&found_[0], sizes_.data(), kSizes * sizeof(std::uint32_t)) && stream_.stage(CudaStage::none);
}

bool LightFieldSlot::submit(const ImageView& image, std::uint16_t least, std::size_t rounds) noexcept {
  if (image.shape.pixels() != image_.size() || !stream_.stage(CudaStage::upload) ||
      !stream_.upload(image_.data(), image.data, image.shape.bytes()))
    return false;
  const Frame frame{image.shape, uniform_limit_, least, rounds};
  frame_ = frame;
  if (!graph_ || stream_.timed()) return queue_frame(frame);
  if (!(frame == recorded_frame_) && !recorded_.record(stream_, [&] { return queue_frame(frame); })) return false;
  recorded_frame_ = frame;
  return recorded_.launch(stream_);
}

bool LightFieldSlot::collect(DeviceFrame& frame) noexcept {
  if (!stream_.synchronize()) return false;
  frame.lit_pixels = found_[kLit], frame.rays = found_[kRays], frame.pixels = found_[kPixels];
  const std::size_t written = std::min(frame.lit_pixels, lit_.size());
  stream_.tell(CudaStage::lit_pixels, frame_.shape.bytes() + written * sizeof(std::uint32_t));
  tell_rays(written);
  if (explainer_.needs_more_turns()) return find_particles(frame_.least, frame_.rounds, frame.particles);
  explainer_.read(frame.particles);
  return true;
}

bool LightFieldSlot::find_candidates(std::span<const std::uint8_t> taken, std::uint16_t least,
                                     std::vector<Candidate>& candidates, std::size_t& refused) noexcept {
  const std::size_t rays = found_[kRays], room = std::min(candidates.capacity(), candidate_.size());
  if (taken.size() < rays || !stream_.stage(CudaStage::upload) || !stream_.upload(taken_.data(), taken.data(), rays) ||
      !queue_candidates(taken_.data(), least) || !stream_.synchronize())
    return false;
  const std::size_t kept = std::min<std::size_t>(found_[kCandidates], room);
  refused = found_[kCandidates] - kept;
  candidates.resize(kept);
  return stream_.stage(CudaStage::download) &&
         stream_.download(candidates.data(), candidate_.data(), kept * sizeof(Candidate)) &&
         stream_.stage(CudaStage::none) && stream_.synchronize();
}

}  // namespace rptv
