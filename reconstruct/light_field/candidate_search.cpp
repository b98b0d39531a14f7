// SPDX-License-Identifier: MIT
// Each step by the device if there is one, else by the CPU.
#include "reconstruct/light_field/candidate_search.hpp"

#include <algorithm>

#include "reconstruct/light_field/classify_local_maxima.hpp"
#include "reconstruct/parallel.hpp"

namespace rptv {

namespace {

std::array<std::int32_t, 3> half_widths(const std::vector<double>& radius_um, const VoxelGrid& grid) {
  const auto voxels = [](double um, float step_mm) {
    return static_cast<std::int32_t>(std::clamp(um * 1e-3 / step_mm, 1.0, 64.0));
  };
  return {voxels(radius_um.at(0), grid.step_x_mm), voxels(radius_um.at(1), grid.step_y_mm),
          voxels(radius_um.at(2), grid.step_z_mm)};
}

}  // namespace

CandidateSearch::CandidateSearch(const LightFieldSettings& settings, const LightFieldDevicePlan& plan,
                                 std::uint16_t min_count, const MakeLightFieldDevice& make_device)
    : pixels_to_rays_(plan.pixels_to_rays),
      grid_(plan.grid),
      min_count_(min_count),
      rounds_(static_cast<std::size_t>(settings.explain_away ? settings.explain_rounds : 1)),
      claim_(settings.explain_away),
      classification_(settings.classification),
      density_limit_(settings.density_limit),
      maximum_half_width_(half_widths(settings.maximum_radius_um, grid_)),
      counter_(grid_, plan.max_rays, thread_count(settings.threads)),
      cloud_(static_cast<std::size_t>(settings.max_candidates)),
      dbscan_(grid_, static_cast<std::size_t>(settings.max_candidates), settings.dbscan_radius_voxels,
              static_cast<std::size_t>(settings.dbscan_min_points)) {
  if (settings.counting == "coarse_to_fine") coarse_maxima_.emplace(grid_, thread_count(settings.threads));
  candidates_.reserve(plan.max_candidates);
  if (make_device) device_ = make_device(plan);
}

bool CandidateSearch::by_device(bool done) noexcept {
  if (!done) device_.reset(), device_failed_ = true;
  return done;
}

bool CandidateSearch::tell(const DarkLimit& limit, bool changed) noexcept {
  if (device_ && (changed || !device_has_limit_)) device_has_limit_ = by_device(device_->set_limit(limit));
  return device_ != nullptr;
}

bool CandidateSearch::submit(const ImageView& image, const DarkLimit& limit, bool changed) noexcept {
  return tell(limit, changed) && by_device(device_->submit(image, min_count_, rounds_));
}

bool CandidateSearch::collect(DeviceFrame& frame) noexcept {
  return device_ != nullptr && by_device(device_->collect(frame));
}

std::size_t CandidateSearch::find_lit(const ImageView& image, const DarkLimit& limit, bool changed,
                                      std::span<std::uint32_t> lit) noexcept {
  std::size_t found = 0;
  if (tell(limit, changed) && by_device(device_->find_lit_pixels(image, lit, found))) return found;
  return find_lit_pixels(image, limit, lit);
}

std::size_t CandidateSearch::find_rays(std::span<const std::uint32_t> lit, Rays& rays) noexcept {
  std::size_t refused = 0;
  converted_ = lit;
  if (device_ && by_device(device_->find_rays(lit, rays, refused))) return refused;
  return pixels_to_rays_.convert(lit, rays);
}

bool CandidateSearch::find_particles(Rays& rays, DeviceParticles& particles) noexcept {
  if (!device_) return false;
  if (claim_ && by_device(device_->find_particles(min_count_, rounds_, particles)) && particles.sure) return true;
  if (!read_rays(rays)) pixels_to_rays_.convert(converted_, rays);
  return false;
}

bool CandidateSearch::cloud_is_dense() const noexcept {
  if (classification_ != "auto") return classification_ == "local_maxima";
  const double voxels = static_cast<double>(grid_.size_x) * grid_.size_y * grid_.planes;
  return static_cast<double>(cloud_.voxels().size()) > density_limit_ * voxels;
}

std::span<const Candidate> CandidateSearch::find(const Rays& rays, std::span<const std::uint8_t> taken,
                                                 bool first_round) noexcept {
  candidates_.clear();
  if (device_ && by_device(device_->find_candidates(taken, min_count_, candidates_, refused_))) return candidates_;
  counter_.count(rays, taken, min_count_);
  if (coarse_maxima_) {
    refused_ = coarse_maxima_->find(counter_, min_count_, candidates_);
  } else {
    refused_ = cloud_.collect(counter_);
    if (first_round) dense_ = cloud_is_dense();
    refused_ += dense_ ? classify_local_maxima(counter_, cloud_, maximum_half_width_, candidates_)
                       : dbscan_.classify(counter_, cloud_, candidates_);
  }
  return candidates_;
}

}  // namespace rptv
