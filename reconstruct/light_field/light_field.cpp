// SPDX-License-Identifier: MIT
// The light-field chain, one step a line.
#include "reconstruct/light_field/light_field.hpp"

#include <algorithm>
#include <cmath>

#include "calibration/light_field/object_map.hpp"
#include "reconstruct/light_field/candidate_search.hpp"
#include "reconstruct/light_field/dense_search.hpp"
#include "reconstruct/light_field/ghost_probability.hpp"
#include "reconstruct/light_field/light_field_dark.hpp"
#include "reconstruct/light_field/light_field_volume.hpp"
#include "reconstruct/parallel.hpp"

namespace rptv {

namespace {

ImageShape shape_of(const LightFieldCalibration& calibration) {
  return {static_cast<std::uint32_t>(calibration.sensor.width_px),
          static_cast<std::uint32_t>(calibration.sensor.height_px), 2};
}

double per_pupil_distance(const LightFieldCalibration& calibration) {
  return calibration.lens.exit_pupil_mm > 0 ? 1 / calibration.lens.exit_pupil_mm : 0;
}

}  // namespace

struct LightField::Stages {
  Stages(const LightFieldSettings& s, const LightFieldCalibration& calibration, const ImageView& background,
         const MakeLightFieldDevice& make_device);

  void find_particles(std::size_t lit_pixels) noexcept;
  void explain() noexcept;
  void append(std::span<const FittedParticle> found) noexcept;
  std::size_t keep_unexplained(std::size_t lit_pixels) noexcept;
  void refine(const ImageView& image, std::size_t lit_pixels) noexcept;
  void find_overlapping(const ImageView& image) noexcept;
  void write(Particles& out) const noexcept;
  void tell(Losses& losses) const noexcept;

  const LightFieldSettings settings;
  const ImageShape shape;
  const LensletLattice lattice;
  LightFieldDark dark;
  const PixelsToRays pixels_to_rays;
  const RayWindow window;
  const VoxelGrid grid;
  const std::uint16_t min_count;
  const ObjectMap object_map;
  const bool in_object_space;

  std::vector<std::uint32_t> lit;
  Rays rays;
  const ExplainOptions explain_options;
  CandidateSearch search;
  ExplainAway explain_away;
  DeviceParticles by_device;
  std::unique_ptr<Shake> shake;               // with settings.refine
  std::unique_ptr<DenseSearch> dense_search;  // with settings.refine_search = "grey_values"
  std::vector<FittedParticle> particles;
  LightFieldCounts counts;
};

LightField::Stages::Stages(const LightFieldSettings& s, const LightFieldCalibration& calibration,
                           const ImageView& background, const MakeLightFieldDevice& make_device)
    : settings(s),
      shape(shape_of(calibration)),
      lattice(calibration),
      dark(s, calibration, lattice, shape, background),
      pixels_to_rays(calibration, lattice, static_cast<std::size_t>(s.max_hypotheses)),
      window(lattice, per_pupil_distance(calibration), pixels_to_rays.slope_half_range()),
      grid(make_grid(s, calibration, pixels_to_rays.slope_half_range())),
      min_count(make_min_count(s, calibration)),
      object_map(calibration),
      in_object_space(s.space == "object"),
      lit(static_cast<std::size_t>(s.max_rays)),
      rays(static_cast<std::size_t>(s.max_rays), lattice.size()),
      explain_options(make_explain_options(s, calibration, grid, min_count)),
      search(s,
             {shape, lattice, pixels_to_rays, grid, window, explain_options, rays.capacity(),
              explain_options.max_candidates, explain_options.threads},
             min_count, make_device),
      explain_away(window, explain_options) {
  by_device.found.reserve(explain_options.max_particles);
  particles.reserve(static_cast<std::size_t>(s.max_particles));
  if (!s.refine) return;
  const ShakeOptions options = make_shake_options(s, calibration, explain_options);
  shake = std::make_unique<Shake>(calibration, lattice, options);
  if (s.refine_search == "grey_values") dense_search = std::make_unique<DenseSearch>(calibration, lattice, options);
}

// Appends what the first `lit_pixels` of `lit` show.
void LightField::Stages::find_particles(std::size_t lit_pixels) noexcept {
  counts.refused_pixels += search.find_rays({lit.data(), lit_pixels}, rays);
  by_device.sure = true;
  if (!search.find_particles(rays, by_device)) {
    counts.device_unsure += by_device.sure ? 0 : 1;
    return explain();
  }
  counts.candidates += by_device.candidates, counts.refused_candidates += by_device.refused_candidates;
  counts.rounds += by_device.rounds;
  append(by_device.found);
}

void LightField::Stages::explain() noexcept {
  explain_away.begin(rays);
  for (std::int64_t round = 0; round < (settings.explain_away ? settings.explain_rounds : 1); ++round) {
    const auto candidates = search.find(rays, explain_away.taken(), round == 0);
    counts.refused_candidates += search.refused(), counts.candidates += candidates.size();
    ++counts.rounds;
    if (explain_away.explain(rays, candidates) == 0) break;
  }
  explain_away.settle(rays);
  counts.refused_particles += explain_away.refused();
  append(explain_away.particles());
}

void LightField::Stages::append(std::span<const FittedParticle> found) noexcept {
  const std::size_t kept = std::min(found.size(), particles.capacity() - particles.size());
  counts.refused_particles += found.size() - kept;
  for (const auto& particle : found.first(kept)) particles.push_back(particle);
}

// Those lit pixels that particles leave above the threshold, and well above the shot noise of what they do explain.
std::size_t LightField::Stages::keep_unexplained(std::size_t lit_pixels) noexcept {
  constexpr float kSigmas = 4;
  const auto end = std::remove_if(lit.begin(), lit.begin() + static_cast<std::ptrdiff_t>(lit_pixels), [&](auto pixel) {
    const float noise = std::sqrt(shake->explained(pixel) / static_cast<float>(settings.electrons_per_grey));
    return shake->unexplained(pixel) < dark.threshold_of(pixel) + kSigmas * noise;
  });
  return static_cast<std::size_t>(end - lit.begin());
}

void LightField::Stages::refine(const ImageView& image, std::size_t lit_pixels) noexcept {
  shake->begin(image, dark.now().mean);
  if (dense_search) return find_overlapping(image);
  particles.resize(shake->refine(particles, 0));
  for (std::int64_t round = 1; round < settings.refine_rounds; ++round) {
    lit_pixels = keep_unexplained(lit_pixels);
    const std::size_t known = particles.size();
    find_particles(lit_pixels);
    if (particles.size() == known) break;
    particles.resize(shake->refine(particles, known));
  }
  std::sort(particles.begin(), particles.end(), by_support);
}

// Rays only show how bright a particle is.
void LightField::Stages::find_overlapping(const ImageView& image) noexcept {
  dense_search->begin(image, dark.now().mean);
  const auto found = dense_search->find(particles);
  const auto spreads = dense_search->spreads();
  particles.clear();
  for (std::size_t k = 0; k < found.size(); ++k) {
    auto& particle = particles.emplace_back();
    particle.at = found[k].at, particle.light = found[k].light, particle.shared = spreads[k].shared;
    counts.rough_covariances += spreads[k].cut ? 1 : 0;
  }
  particles.resize(shake->describe(particles));
  counts.refused_candidates += dense_search->refused_hits();
  counts.refused_particles += dense_search->refused();
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

void LightField::reconstruct(const FrameSet& frames, Particles& out) noexcept {
  if (frames.cameras == 1 && !frames.info().torn) return reconstruct(frames.frames[0].view(), out);
  out.clear();
  ++stages_->counts.refused_frames;
  stages_->tell(losses_);
}

void LightField::reconstruct(const ImageView& image, Particles& out) noexcept {
  auto& s = *stages_;
  out.clear();
  if (image.data == nullptr || !image.shape.has_size_of(s.shape)) {
    ++s.counts.refused_frames;
    return s.tell(losses_);
  }
  s.dark.refresh();
  const std::size_t lit = s.search.find_lit(image, s.dark.now().limit, s.dark.follows(), s.lit);
  s.counts.lit_pixels = lit, s.counts.candidates = 0, s.counts.rounds = 0;
  s.counts.refused_pixels += lit - std::min(lit, s.lit.size());
  s.particles.clear();
  s.find_particles(std::min(lit, s.lit.size()));
  s.counts.rays = s.rays.size;
  if (s.shake) s.refine(image, std::min(lit, s.lit.size()));
  s.write(out);
  s.dark.offer(image);
  if ((s.counts.device_failed = s.search.device_failed())) count_set_without_device();
  ++s.counts.frames;
  s.tell(losses_);
}

}  // namespace rptv
