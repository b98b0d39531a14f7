// SPDX-License-Identifier: MIT
// Noise and grey values, pixel by pixel.
#include "simulation/exposure.hpp"

#include <algorithm>
#include <cmath>

#include "simulation/random.hpp"

namespace rptv {

namespace {

constexpr std::uint64_t kDarkStream = std::uint64_t{5} << 56;  // above the frame number

template <class Pixel>
Pixel to_grey(double value, double full_scale) noexcept {
  return static_cast<Pixel>(std::lrint(std::clamp(value, 0.0, full_scale)));
}

}  // namespace

Exposure::Exposure(const ScenarioSettings& scenario)
    : camera_(scenario.camera),
      seed_(static_cast<std::uint64_t>(scenario.seed)),
      shape_{static_cast<std::uint32_t>(scenario.camera.width_px),
             static_cast<std::uint32_t>(scenario.camera.height_px), scenario.camera.bits > 8 ? 2U : 1U},
      full_scale_(std::pow(2.0, static_cast<double>(scenario.camera.bits)) - 1) {}

template <class Pixel>
void Exposure::expose_as(std::span<const float> expected, double stray_e, std::uint64_t stream, Pixel* pixels) const {
  const double per_electron = 1.0 / camera_.gain_e_per_dn;
  const auto light = [&](std::size_t i) {
    return (expected.empty() ? 0.0 : static_cast<double>(expected[i])) + stray_e;
  };
  if (!camera_.noise) {
    for (std::size_t i = 0; i < shape_.pixels(); ++i)
      pixels[i] = to_grey<Pixel>(light(i) * per_electron + camera_.black_level_dn, full_scale_);
    return;
  }
  Random random(seed_, stream);
  const float* normal = normal_table();
  std::uint64_t four = 0;
  for (std::size_t i = 0; i < shape_.pixels(); ++i) {
    if (i % 4 == 0) four = random.bits();
    const double mean = light(i);
    const double electrons = mean > 0 ? random.poisson(mean) : 0.0;
    const double read = camera_.read_noise_e * static_cast<double>(normal[four & 0xffff]);
    four >>= 16;
    pixels[i] = to_grey<Pixel>((electrons + read) * per_electron + camera_.black_level_dn, full_scale_);
  }
}

void Exposure::expose(std::span<const float> expected, std::uint64_t stream, std::span<std::byte> pixels) const {
  if (shape_.bytes_per_pixel == 1)
    expose_as(expected, camera_.background_e, stream, reinterpret_cast<std::uint8_t*>(pixels.data()));
  else
    expose_as(expected, camera_.background_e, stream, reinterpret_cast<std::uint16_t*>(pixels.data()));
}

void Exposure::expose_dark(std::span<std::byte> pixels) const {
  if (shape_.bytes_per_pixel == 1)
    expose_as({}, 0, kDarkStream, reinterpret_cast<std::uint8_t*>(pixels.data()));
  else
    expose_as({}, 0, kDarkStream, reinterpret_cast<std::uint16_t*>(pixels.data()));
}

void Exposure::mean_without_light(std::span<std::byte> pixels) const {
  const double value = camera_.black_level_dn + camera_.background_e / camera_.gain_e_per_dn;
  if (shape_.bytes_per_pixel == 1)
    std::fill_n(reinterpret_cast<std::uint8_t*>(pixels.data()), shape_.pixels(),
                to_grey<std::uint8_t>(value, full_scale_));
  else
    std::fill_n(reinterpret_cast<std::uint16_t*>(pixels.data()), shape_.pixels(),
                to_grey<std::uint16_t>(value, full_scale_));
}

}  // namespace rptv
