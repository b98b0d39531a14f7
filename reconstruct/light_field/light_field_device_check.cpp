// SPDX-License-Identifier: MIT
// One image through both, step by step.
#include "reconstruct/light_field/light_field_device_check.hpp"

#include <algorithm>
#include <cstring>
#include <initializer_list>
#include <random>

#include "reconstruct/light_field/coarse_maxima.hpp"

namespace rptv {

namespace {

constexpr std::uint16_t kDark = 10;

// Bright grains of a few pixels, so that rays gather somewhere; about one pixel in twenty is lit.
std::vector<std::uint16_t> scattered_light(const ImageShape& shape) {
  std::vector<std::uint16_t> pixels(shape.pixels());
  std::mt19937 random(1);
  const auto width = std::size_t{shape.width_px};
  for (std::size_t grain = 0; grain < pixels.size() / 180; ++grain) {
    const std::size_t at = random() % pixels.size();
    for (const std::size_t step : {std::size_t{0}, std::size_t{1}, std::size_t{2}, width, width + 1, width + 2,
                                   2 * width, 2 * width + 1, 2 * width + 2})
      if (at + step < pixels.size()) pixels[at + step] = static_cast<std::uint16_t>(kDark + random() % 3);
  }
  return pixels;
}

template <class T>
bool same(std::span<const T> a, std::span<const T> b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

bool same(const Rays& a, const Rays& b) {
  return a.pixels == b.pixels && same<Ray>(a.all(), b.all()) && a.first_of_lenslet == b.first_of_lenslet &&
         std::equal(a.pixel.begin(), a.pixel.begin() + static_cast<std::ptrdiff_t>(a.size), b.pixel.begin()) &&
         std::equal(a.same_pixel.begin(), a.same_pixel.begin() + static_cast<std::ptrdiff_t>(a.size),
                    b.same_pixel.begin());
}

}  // namespace

std::string disagreement(LightFieldDevice& device, const LightFieldDevicePlan& plan) {
  ImageShape shape = plan.shape;
  shape.bytes_per_pixel = 2;
  const auto pixels = scattered_light(shape);
  const ImageView image{reinterpret_cast<const std::byte*>(pixels.data()), shape};
  const DarkLimit limit(shape, kDark, 0);
  std::vector<std::uint32_t> lit(plan.max_rays), device_lit(plan.max_rays);
  std::size_t device_found = 0;
  const std::size_t found = find_lit_pixels(image, limit, lit);
  if (!device.set_limit(limit) || !device.find_lit_pixels(image, device_lit, device_found))
    return "it fails at the threshold";
  if (found != device_found || lit != device_lit) return "it finds other lit pixels";
  lit.resize(std::min(found, lit.size()));

  Rays rays(plan.max_rays, plan.lattice.size()), device_rays(plan.max_rays, plan.lattice.size());
  std::size_t device_refused = 0;
  const std::size_t refused = plan.pixels_to_rays.convert(lit, rays);
  if (!device.find_rays(lit, device_rays, device_refused)) return "it fails at the rays";
  if (refused != device_refused || !same(rays, device_rays)) return "it finds other rays";

  RayCounter counter(plan.grid, plan.max_rays, 1);
  CoarseMaxima maxima(plan.grid, 1);
  std::vector<std::uint8_t> taken(plan.max_rays);
  std::vector<Candidate> candidates, device_candidates;
  candidates.reserve(plan.max_candidates), device_candidates.reserve(plan.max_candidates);
  for (const std::uint16_t least : std::initializer_list<std::uint16_t>{1, 3, 10}) {
    candidates.clear(), device_candidates.clear();
    counter.count(rays, taken, least);
    const std::size_t left_out = maxima.find(counter, least, candidates);
    std::size_t device_left_out = 0;
    if (!device.find_candidates(taken, least, device_candidates, device_left_out)) return "it fails at the candidates";
    if (left_out != device_left_out || !same<Candidate>(candidates, device_candidates))
      return "it finds other candidates";
    for (std::size_t i = least; i < taken.size(); i += 3) taken[i] = 1;
  }
  return {};
}

}  // namespace rptv
