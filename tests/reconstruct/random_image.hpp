// SPDX-License-Identifier: MIT
// Images that make a detector stumble: odd sizes, few grey values (plateaus everywhere), lit borders, all depths.
#pragma once

#include <rapidcheck.h>

#include <cstring>
#include <random>
#include <vector>

#include "core/image.hpp"
#include "reconstruct/lit_pixels.hpp"

namespace rptv::testing {

struct RandomImage {
  ImageShape shape;
  std::vector<std::byte> bytes;

  ImageView view() const { return {bytes.data(), shape}; }
  std::uint16_t at(std::int32_t x, std::int32_t y) const {
    const std::size_t i = static_cast<std::size_t>(y) * shape.width_px + static_cast<std::size_t>(x);
    return shape.bytes_per_pixel == 1 ? view().as_u8()[i] : view().as_u16()[i];
  }
  void set(std::int32_t x, std::int32_t y, std::uint16_t grey) {
    const std::size_t i = static_cast<std::size_t>(y) * shape.width_px + static_cast<std::size_t>(x);
    if (shape.bytes_per_pixel == 1)
      bytes[i] = static_cast<std::byte>(grey);
    else
      std::memcpy(&bytes[2 * i], &grey, 2);
  }
};

/// 1 to `most` pixels a side, 8 to 16 bit. Between a tenth and all of the pixels have one of a few grey values.
inline RandomImage any_image(std::uint32_t most) {
  using rc::gen::inRange;
  RandomImage image;
  image.shape = {*inRange(1U, most + 1), *inRange(1U, most + 1), *inRange(1U, 3U)};
  image.bytes.resize(image.shape.bytes());
  const unsigned top = image.shape.bytes_per_pixel == 1 ? 255U : *rc::gen::element(1023U, 4095U, 65535U);
  const auto levels = *rc::gen::element(1U, 2U, 5U, top);
  const auto lit_in_ten = *inRange(1U, 11U);
  std::mt19937 random(*inRange(0U, 1U << 30));
  for (std::int32_t y = 0; y < static_cast<std::int32_t>(image.shape.height_px); ++y)
    for (std::int32_t x = 0; x < static_cast<std::int32_t>(image.shape.width_px); ++x)
      if (random() % 10 < lit_in_ten)
        image.set(x, y, static_cast<std::uint16_t>(top - random() % levels * (top / levels)));
  return image;
}

/// The same for all pixels, or the grey values of another random image.
inline DarkLimit any_limit(const RandomImage& image) {
  const double threshold = *rc::gen::element(0.0, 20.0, 300.0, 70000.0);
  if (*rc::gen::arbitrary<bool>()) return DarkLimit(image.shape, 100, threshold);
  RandomImage background = image;
  std::mt19937 random(*rc::gen::inRange(0U, 1U << 30));
  for (auto& byte : background.bytes) byte = static_cast<std::byte>(random() % 256);
  return DarkLimit(background.view(), threshold);
}

}  // namespace rptv::testing
