// SPDX-License-Identifier: MIT
// What LightField is made of, and the frames that it has begun with.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "calibration/light_field/object_map.hpp"
#include "reconstruct/light_field/candidate_search.hpp"
#include "reconstruct/light_field/dense_search.hpp"
#include "reconstruct/light_field/light_field.hpp"
#include "reconstruct/light_field/light_field_dark.hpp"
#include "reconstruct/light_field/neighbour_spread.hpp"
#include "reconstruct/light_field/pair_spread.hpp"
#include "reconstruct/light_field/shake.hpp"

namespace rptv {

struct LightField::Stages {
  Stages(const LightFieldSettings& s, const LightFieldCalibration& calibration, const ImageView& background,
         const MakeLightFieldDevice& make_device);

  bool does_frames() const noexcept;
  void submit(const ImageView& image) noexcept;
  bool find() noexcept;
  bool find_by_device() noexcept;
  void find_here(const ImageView& image) noexcept;
  void find_particles(std::size_t lit_pixels) noexcept;
  void accept(const DeviceParticles& found) noexcept;
  void explain() noexcept;
  void append(std::span<const FittedParticle> found) noexcept;
  std::size_t keep_unexplained(std::size_t lit_pixels) noexcept;
  void refine(const ImageView& image, std::size_t lit_pixels) noexcept;
  void find_overlapping(const ImageView& image) noexcept;
  void take_over(std::span<const JointParticle> found) noexcept;
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
  /// A frame that was submitted: without data when it is refused.
  struct Begun {
    ImageView image;
    bool on_device = false;
  };
  std::array<Begun, kDeviceFrames> begun;
  std::size_t submitted = 0, collected = 0;
  DeviceFrame frame;
  std::unique_ptr<Shake> shake;                 // with settings.refine
  std::unique_ptr<DenseSearch> dense_search;    // with settings.refine_search = "grey_values"
  std::unique_ptr<PairSpread> pair_spread;      // with settings.refine
  std::unique_ptr<NeighbourSpread> neighbours;  // with settings.refine_search = "rays"
  std::vector<FittedParticle> particles;
  LightFieldCounts counts;
};

}  // namespace rptv
