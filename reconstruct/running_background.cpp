// SPDX-License-Identifier: MIT
// The learner's loop, and the hand-over of strips to it.
#include "reconstruct/running_background.hpp"

#include <pthread.h>

#include <algorithm>
#include <cstring>

namespace rptv {

namespace {
constexpr std::int64_t kPatienceNs = 200'000'000;

PixelStatistics statistics_of(const ImageShape& shape, const DarkPixels& initial, double sigma, bool image,
                              std::int64_t window) {
  if (image) return PixelStatistics(initial.mean, sigma, window);
  return PixelStatistics(shape.pixels(), static_cast<double>(initial.mean.at(0)), sigma, window);
}

std::uint32_t strip_row(const ImageShape& shape, std::uint32_t strip) noexcept {
  return static_cast<std::uint32_t>(std::uint64_t{shape.height_px} * strip / RunningBackground::kStrips);
}

}  // namespace

RunningBackground::RunningBackground(const ImageShape& shape, const DarkPixels& initial, double sigma,
                                     bool initial_is_image, const RunningBackgroundOptions& options)
    : shape_(shape),
      options_(options),
      statistics_(statistics_of(shape, initial, sigma, initial_is_image, options.window)),
      dark_(initial),
      strip_(std::size_t{shape.width_px} * (shape.height_px / kStrips + 1) * 2),
      learner_([this] { learn(); }) {
  pthread_setname_np(learner_.native_handle(), "rptv-background");
}

RunningBackground::~RunningBackground() {
  ending_.store(true, std::memory_order_release);
  wake_.notify();
  learner_.join();
}

void RunningBackground::offer(const ImageView& image) noexcept {
  // acquire, pairs with take_strip(): the learner has done with the strip that we are about to write over.
  if (full_.load(std::memory_order_acquire)) return;
  const std::uint32_t first = strip_row(shape_, next_strip_), last = strip_row(shape_, next_strip_ + 1);
  strip_bytes_per_pixel_ = image.shape.bytes_per_pixel;
  std::memcpy(strip_.data(), image.data + first * image.shape.row_bytes(), (last - first) * image.shape.row_bytes());
  full_.store(true, std::memory_order_release);
  wake_.notify();
}

void RunningBackground::learn() noexcept {
  while (!ending_.load(std::memory_order_acquire)) {
    const std::uint32_t seen = wake_.prepare();  // before the look: a strip that comes after it ends the wait
    if (full_.load(std::memory_order_acquire))
      take_strip();
    else if (!ending_.load(std::memory_order_acquire))
      wake_.wait(seen, kPatienceNs);
  }
}

void RunningBackground::take_strip() noexcept {
  const std::size_t first = std::size_t{strip_row(shape_, next_strip_)} * shape_.width_px;
  const std::size_t last = std::size_t{strip_row(shape_, next_strip_ + 1)} * shape_.width_px;
  if (strip_bytes_per_pixel_ == 1)
    statistics_.update(first, std::span(reinterpret_cast<const std::uint8_t*>(strip_.data()), last - first));
  else
    statistics_.update(first, std::span(reinterpret_cast<const std::uint16_t*>(strip_.data()), last - first));
  next_strip_ = (next_strip_ + 1) % kStrips;
  if (next_strip_ == 0) publish();
  full_.store(false, std::memory_order_release);
}

void RunningBackground::publish() noexcept {
  statistics_.end_round();
  DarkPixels& dark = dark_.back();
  const auto mean = statistics_.mean(), sigma = statistics_.sigma();
  std::copy(mean.begin(), mean.end(), dark.mean.begin());
  dark.limit.follow(mean, sigma, options_.share, options_.threshold, options_.threshold_sigmas);
  dark_.publish();
  published_.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace rptv
