// SPDX-License-Identifier: MIT
// One image through both, step by step.
#include "reconstruct/light_field/device_trial.hpp"

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

/// Both sides' memory, and the steps on each.
class Trial {
 public:
  Trial(LightFieldDevice& device, const LightFieldDevicePlan& plan)
      : device_(device),
        plan_(plan),
        pixels_(scattered_light(plan.shape)),
        image_{reinterpret_cast<const std::byte*>(pixels_.data()), {plan.shape.width_px, plan.shape.height_px, 2}},
        limit_(image_.shape, kDark, 0),
        counter_(plan.grid, plan.max_rays, plan.threads),
        maxima_(plan.grid, plan.threads),
        taken_(plan.max_rays) {
    for (Side* side : {&cpu_, &other_}) side->candidates.reserve(plan.max_candidates);
  }

  std::string compare() {
    if (!device_.set_limit(limit_) || !device_lit()) return "it fails at the threshold";
    cpu_lit();
    if (cpu_.found != other_.found || cpu_.lit != other_.lit) return "it finds other lit pixels";
    if (!device_rays()) return "it fails at the rays";
    cpu_rays();
    if (cpu_.refused != other_.refused || !same(cpu_.rays, other_.rays)) return "it finds other rays";
    for (const std::uint16_t least : std::initializer_list<std::uint16_t>{1, 3, 10}) {
      if (!device_candidates(least)) return "it fails at the candidates";
      cpu_candidates(least);
      if (cpu_.refused != other_.refused || !same<Candidate>(cpu_.candidates, other_.candidates))
        return "it finds other candidates";
      for (std::size_t i = least; i < taken_.size(); i += 3) taken_[i] = 1;
    }
    return {};
  }
  void time(DeviceTrial& trial) {
    constexpr std::uint16_t kLeast = 10;
    std::fill(taken_.begin(), taken_.end(), std::uint8_t{0});
    time_trial(
        trial, [&] { cpu_lit(), cpu_rays(), cpu_candidates(kLeast); },
        [&] { device_lit() && device_rays() && device_candidates(kLeast); });
  }

 private:
  std::span<const std::uint32_t> lit() const { return {cpu_.lit.data(), std::min(cpu_.found, cpu_.lit.size())}; }

  void cpu_lit() { cpu_.found = find_lit_pixels(image_, limit_, cpu_.lit); }
  void cpu_rays() { cpu_.refused = plan_.pixels_to_rays.convert(lit(), cpu_.rays); }
  void cpu_candidates(std::uint16_t least) {
    cpu_.candidates.clear();
    counter_.count(cpu_.rays, taken_, least);
    cpu_.refused = maxima_.find(counter_, least, cpu_.candidates);
  }
  bool device_lit() { return device_.find_lit_pixels(image_, other_.lit, other_.found); }
  bool device_rays() { return device_.find_rays(lit(), other_.rays, other_.refused); }
  bool device_candidates(std::uint16_t least) {
    other_.candidates.clear();
    return device_.find_candidates(taken_, least, other_.candidates, other_.refused);
  }

  struct Side {
    explicit Side(const LightFieldDevicePlan& plan) : lit(plan.max_rays), rays(plan.max_rays, plan.lattice.size()) {}
    std::vector<std::uint32_t> lit;
    std::size_t found = 0, refused = 0;
    Rays rays;
    std::vector<Candidate> candidates;
  };
  LightFieldDevice& device_;
  const LightFieldDevicePlan& plan_;
  const std::vector<std::uint16_t> pixels_;
  const ImageView image_;
  const DarkLimit limit_;
  Side cpu_{plan_}, other_{plan_};
  RayCounter counter_;
  CoarseMaxima maxima_;
  std::vector<std::uint8_t> taken_;
};

}  // namespace

DeviceTrial try_device(LightFieldDevice& device, const LightFieldDevicePlan& plan) {
  DeviceTrial result;
  Trial trial(device, plan);
  result.differs = trial.compare();
  if (result.differs.empty()) trial.time(result);
  return result;
}

}  // namespace rptv
