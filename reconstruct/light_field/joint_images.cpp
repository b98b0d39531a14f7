// SPDX-License-Identifier: MIT
// One block of memory, handed out image by image.
#include "reconstruct/light_field/joint_images.hpp"

#include <algorithm>

namespace rptv {

void JointImages::begin(std::size_t particles) noexcept {
  count_ = particles;
  std::fill_n(images_.begin(), particles, Image{});
  end_ = 0;
}

bool JointImages::take_room(std::size_t k, std::size_t pixels) noexcept {
  std::size_t first = end_.load(std::memory_order_relaxed);
  do {
    if (pixels > pixel_.size() - first) return false;
  } while (!end_.compare_exchange_weak(first, first + pixels, std::memory_order_relaxed));
  images_[k] = {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(pixels)};
  return true;
}

bool JointImages::put(std::size_t k, const ParticleImage& image) noexcept {
  if (!take_room(k, image.size)) return false;
  const std::size_t first = images_[k].first;
  std::copy_n(image.pixel.data(), image.size, pixel_.data() + first);
  std::copy_n(image.value.data(), image.size, value_.data() + first);
  std::copy_n(image.dx.data(), image.size, dx_.data() + first);
  std::copy_n(image.dy.data(), image.size, dy_.data() + first);
  std::copy_n(image.dz.data(), image.size, dz_.data() + first);
  return true;
}

bool JointImages::copy(std::size_t k, const JointImages& from) noexcept {
  const Image source = from.images_[k];
  if (!take_room(k, source.count)) return false;
  const std::size_t first = images_[k].first;
  std::copy_n(from.pixel_.data() + source.first, source.count, pixel_.data() + first);
  std::copy_n(from.value_.data() + source.first, source.count, value_.data() + first);
  std::copy_n(from.dx_.data() + source.first, source.count, dx_.data() + first);
  std::copy_n(from.dy_.data() + source.first, source.count, dy_.data() + first);
  std::copy_n(from.dz_.data() + source.first, source.count, dz_.data() + first);
  return true;
}

void JointImages::paint(std::size_t k, double light, std::span<float> sensor) const noexcept {
  const auto l = static_cast<float>(light);
  const Image image = images_[k];
  for (std::size_t e = image.first; e < std::size_t{image.first} + image.count; ++e) sensor[pixel_[e]] += l * value_[e];
}

}  // namespace rptv
