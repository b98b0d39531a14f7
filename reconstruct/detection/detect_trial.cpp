// SPDX-License-Identifier: MIT
// Painted spots, detected twice.
#include "reconstruct/detection/detect_trial.hpp"

#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "reconstruct/detection/spot_finder.hpp"
#include "reconstruct/parallel.hpp"

namespace rptv {

namespace {

/// Noise below the limits, and round spots above them, some of which touch.
class PaintedImage {
 public:
  PaintedImage(const ImageShape& shape, const DarkPixels& dark, unsigned seed) : shape_(shape), pixels_(shape.bytes()) {
    constexpr std::size_t kPixelsPerSpot = 2000;
    std::mt19937 random(seed);
    for (std::size_t i = 0; i < shape.pixels(); ++i)
      put(i, std::max(0.0F, dark.mean[i % dark.mean.size()] + static_cast<float>(random() % 3) - 1));
    for (std::size_t spot = 0; spot < shape.pixels() / kPixelsPerSpot + 2; ++spot) paint(dark, random);
  }
  ImageView view() const { return {pixels_.data(), shape_}; }

 private:
  static constexpr int kReach = 4;

  void paint(const DarkPixels& dark, std::mt19937& random) {
    const auto at = [&](std::uint32_t length) { return static_cast<double>(random() % (16 * length)) / 16; };
    const double x = at(shape_.width_px), y = at(shape_.height_px), peak = 2 + at(4);
    for (int row = -kReach; row <= kReach; ++row)
      for (int column = -kReach; column <= kReach; ++column) {
        const auto px = static_cast<std::int64_t>(x) + column, py = static_cast<std::int64_t>(y) + row;
        if (px < 0 || py < 0 || px >= shape_.width_px || py >= shape_.height_px) continue;
        const auto i = static_cast<std::size_t>(py) * shape_.width_px + static_cast<std::size_t>(px);
        const double dx = static_cast<double>(px) - x, dy = static_cast<double>(py) - y;
        const std::size_t known = dark.limit.uniform() ? 0 : i;
        const float over = static_cast<float>(dark.limit.limits()[known]) - dark.mean[known];
        put(i, get(i) + over * static_cast<float>(peak * std::exp(-0.5 * (dx * dx + dy * dy))));
      }
  }
  float get(std::size_t i) const {
    if (shape_.bytes_per_pixel == 1) return std::to_integer<std::uint8_t>(pixels_[i]);
    std::uint16_t value;
    std::memcpy(&value, &pixels_[2 * i], 2);
    return value;
  }
  void put(std::size_t i, float grey) {
    const auto value = static_cast<std::uint16_t>(std::min(grey, shape_.bytes_per_pixel == 1 ? 255.0F : 65535.0F));
    std::memcpy(&pixels_[shape_.bytes_per_pixel * i], &value, shape_.bytes_per_pixel);
  }

  ImageShape shape_;
  std::vector<std::byte> pixels_;
};

bool same(const Detections& a, const Detections& b) {
  return a.overflow() == b.overflow() && a.x_px == b.x_px && a.y_px == b.y_px && a.sigma_px == b.sigma_px &&
         a.grey == b.grey && a.area_px == b.area_px;
}

}  // namespace

DeviceTrial try_device(DetectDevice& device, const DetectDevicePlan& plan, std::size_t threads) {
  const std::size_t cameras = plan.shapes.size();
  std::vector<SpotFinder> finders;
  std::vector<PaintedImage> images;
  std::vector<ImageView> views;
  std::vector<Detections> cpu, other;
  std::vector<DetectorCounts> counts(cameras);
  for (std::size_t c = 0; c < cameras; ++c) {
    finders.emplace_back(plan.settings, plan.shapes[c], best_instruction_set());
    views.push_back(images.emplace_back(plan.shapes[c], plan.dark[c], static_cast<unsigned>(c + 1)).view());
    for (auto* side : {&cpu, &other}) side->emplace_back(static_cast<std::size_t>(plan.settings.max_detections));
  }
  const auto on_cpu = [&] {
    parallel_for(cameras, std::min(threads, cameras), [&](std::size_t c, std::size_t) {
      cpu[c].clear();
      if (plan.shapes[c].bytes_per_pixel == 1)
        finders[c].find<std::uint8_t>(views[c], plan.dark[c], cpu[c], counts[c]);
      else
        finders[c].find<std::uint16_t>(views[c], plan.dark[c], cpu[c], counts[c]);
    });
  };
  DeviceTrial trial;
  on_cpu();
  if (!device.detect(views, other)) {
    trial.differs = "it fails";
    return trial;
  }
  for (std::size_t c = 0; c < cameras; ++c)
    if (!same(cpu[c], other[c])) trial.differs = "it finds other particle images";
  if (trial.differs.empty()) time_trial(trial, on_cpu, [&] { device.detect(views, other); });
  return trial;
}

}  // namespace rptv
