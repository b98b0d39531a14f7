// SPDX-License-Identifier: MIT
// Frames in, particles out: by a device as a whole, or by the steps of light_field_stages.cpp.
#include "reconstruct/light_field/light_field.hpp"

#include <algorithm>

#include "reconstruct/light_field/ghost_probability.hpp"
#include "reconstruct/light_field/light_field_stages.hpp"
#include "reconstruct/light_field/light_field_volume.hpp"

namespace rptv {

bool LightField::Stages::does_frames() const noexcept { return search.does_frames() && !shake; }

void LightField::Stages::submit(const ImageView& image) noexcept {
  const bool fits = image.data != nullptr && image.shape.has_size_of(shape);
  Begun& next = begun[submitted++ % begun.size()];
  next = {fits ? image : ImageView{}, false};
  if (!fits || !does_frames()) return;
  dark.refresh();
  next.on_device = search.submit(image, dark.now().limit, dark.follows());
  if (next.on_device) dark.offer(image);
}

// The particles of the frame that was submitted first; false when it is refused.
bool LightField::Stages::find() noexcept {
  const Begun first = begun[collected++ % begun.size()];
  particles.clear();
  if (first.image.data == nullptr) {
    ++counts.refused_frames;
    return false;
  }
  counts.candidates = 0, counts.rounds = 0;
  if (!first.on_device || !find_by_device()) {
    dark.refresh();
    find_here(first.image);
    if (!first.on_device) dark.offer(first.image);
  }
  counts.device_failed = search.device_failed();
  ++counts.frames;
  return true;
}

bool LightField::Stages::find_by_device() noexcept {
  if (!search.collect(frame)) return false;
  rays.size = frame.rays, rays.pixels = frame.pixels;
  if (!frame.particles.sure && !search.read_rays(rays)) return false;
  counts.lit_pixels = frame.lit_pixels, counts.refused_pixels += frame.lit_pixels - frame.pixels;
  counts.rays = frame.rays;
  accept(frame.particles);
  return true;
}

void LightField::Stages::find_here(const ImageView& image) noexcept {
  const std::size_t found = search.find_lit(image, dark.now().limit, dark.follows(), lit);
  const std::size_t kept = std::min(found, lit.size());
  counts.lit_pixels = found, counts.refused_pixels += found - kept;
  find_particles(kept);
  counts.rays = rays.size;
  if (shake) refine(image, kept);
}

void LightField::Stages::write(Particles& out) const noexcept {
  for (const auto& found : particles) {
    const auto& c = found.covariance;
    Point3 at{found.at.x, found.at.y, found.at.z};
    Covariance covariance{c.xx, c.xy, c.xz, c.yy, c.yz, c.zz};
    if (in_object_space) {
      covariance = object_map.to_object(covariance, object_map.jacobian(at));
      at = object_map.to_object(at);
    }
    out.push({at[0], at[1], at[2], found.residual_mm, found.support, covariance,
              shake ? found.ghost : ghost_probability_by_support(found.support / min_count)});
  }
}

void LightField::Stages::tell(Losses& losses) const noexcept {
  losses.set(LossCause::frame_refused, counts.refused_frames);
  losses.set(LossCause::ray_overflow, counts.refused_pixels);
  losses.set(LossCause::candidate_overflow, counts.refused_candidates);
  losses.set(LossCause::particle_overflow, counts.refused_particles);
}

LightField::LightField(const LightFieldSettings& settings, const LightFieldCalibration& calibration,
                       const ImageView& background, const MakeLightFieldDevice& make_device) {
  check_choices(settings);
  calibration.validate(settings.calibration.empty() ? "the light-field calibration" : settings.calibration);
  stages_ = std::make_unique<Stages>(settings, calibration, background, make_device);
}

LightField::~LightField() = default;
std::span<const FittedParticle> LightField::fitted() const noexcept { return stages_->particles; }
const LightFieldCounts& LightField::counts() const noexcept { return stages_->counts; }
std::uint16_t LightField::min_count() const noexcept { return stages_->min_count; }

bool LightField::page_lock(std::span<std::byte> memory) noexcept { return stages_->search.page_lock(memory); }

std::size_t LightField::most_in_flight() const noexcept { return stages_->does_frames() ? kDeviceFrames : 1; }

void LightField::reconstruct(const FrameSet& frames, Particles& out) noexcept {
  submit(frames);
  collect(out);
}

void LightField::reconstruct(const ImageView& image, Particles& out) noexcept {
  submit(image);
  collect(out);
}

void LightField::submit(const FrameSet& frames) noexcept {
  submit(frames.cameras == 1 && !frames.info().torn ? frames.frames[0].view() : ImageView{});
}

void LightField::submit(const ImageView& image) noexcept { stages_->submit(image); }

void LightField::collect(Particles& out) noexcept {
  out.clear();
  if (stages_->find()) {
    stages_->write(out);
    if (stages_->counts.device_failed) count_set_without_device();
  }
  stages_->tell(losses_);
}

}  // namespace rptv
