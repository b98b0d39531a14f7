// SPDX-License-Identifier: MIT
// The light-field chain, one step a line.
#include "reconstruct/light_field/light_field_stages.hpp"

#include <algorithm>
#include <cmath>

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
  frame.particles.found.reserve(explain_options.max_particles);
  particles.reserve(static_cast<std::size_t>(s.max_particles));
  if (!s.refine) return;
  const ShakeOptions options = make_shake_options(s, calibration, explain_options);
  shake = std::make_unique<Shake>(calibration, lattice, options);
  pair_spread = std::make_unique<PairSpread>(calibration, lattice, options);
  if (s.refine_search == "grey_values")
    dense_search = std::make_unique<DenseSearch>(calibration, lattice, options);
  else
    neighbours = std::make_unique<NeighbourSpread>(calibration, lattice, options);
}

// Appends what the first `lit_pixels` of `lit` show.
void LightField::Stages::find_particles(std::size_t lit_pixels) noexcept {
  counts.refused_pixels += search.find_rays({lit.data(), lit_pixels}, rays);
  if (search.find_particles(rays, frame.particles)) return accept(frame.particles);
  counts.device_unsure += search.does_frames() ? 1 : 0;
  explain();
}

// What a device has found, or else what its rays show.
void LightField::Stages::accept(const DeviceParticles& found) noexcept {
  if (!found.sure) {
    ++counts.device_unsure;
    return explain();
  }
  counts.candidates += found.candidates, counts.refused_candidates += found.refused_candidates;
  counts.rounds += found.rounds;
  append(found.found);
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
    const float noise =
        std::sqrt(std::max(shake->explained()[pixel], 0.0F) / static_cast<float>(settings.electrons_per_grey));
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
  counts.rough_covariances += neighbours->find(image, dark.now().mean, particles);
  shake->begin(image, dark.now().mean);
  particles.resize(shake->describe(particles));
  pair_spread->widen(particles, shake->explained());
  std::sort(particles.begin(), particles.end(), by_support);
}

void LightField::Stages::take_over(std::span<const JointParticle> found) noexcept {
  particles.clear();
  for (const auto& p : found) {
    auto& particle = particles.emplace_back();
    particle.at = p.at, particle.light = p.light;
  }
}

// Rays only show how bright a particle is.
void LightField::Stages::find_overlapping(const ImageView& image) noexcept {
  dense_search->begin(image, dark.now().mean);
  take_over(dense_search->find(particles));
  particles.resize(shake->unite(particles));
  take_over(dense_search->settle(particles));
  const auto spreads = dense_search->spreads();
  for (std::size_t k = 0; k < particles.size(); ++k) {
    particles[k].shared = spreads[k].shared;
    counts.rough_covariances += spreads[k].cut ? 1 : 0;
  }
  shake->begin(image, dark.now().mean);
  particles.resize(shake->describe(particles));
  pair_spread->widen(particles, shake->explained());
  counts.refused_candidates += dense_search->refused_hits();
  counts.refused_particles += dense_search->refused();
}

}  // namespace rptv
