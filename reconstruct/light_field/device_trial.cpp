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

constexpr std::uint16_t kDark = 10, kLeast = 10;
constexpr std::size_t kRounds = 2;

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

bool same(std::span<const FittedParticle> a, const std::vector<FittedParticle>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const FittedParticle& p, const FittedParticle& q) {
    return std::memcmp(&p.at, &q.at, sizeof p.at) == 0 && p.support == q.support && p.residual_mm == q.residual_mm &&
           std::memcmp(&p.covariance, &q.covariance, sizeof p.covariance) == 0;
  });
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
        explain_(plan.window, plan.explain),
        taken_(plan.max_rays) {
    other_particles_.found.reserve(plan.explain.max_particles);
    for (Side* side : {&cpu_, &other_}) side->candidates.reserve(plan.max_candidates);
  }

  std::string compare() {
    if (!device_.set_limit(limit_) || !device_lit()) return "it fails at the threshold";
    cpu_lit();
    use_all();
    if (cpu_.found != other_.found || cpu_.lit != other_.lit) return "it finds other lit pixels";
    if (!device_rays() || !device_.read_rays(other_.rays)) return "it fails at the rays";
    cpu_rays();
    if (cpu_.refused != other_.refused || !same(cpu_.rays, other_.rays)) return "it finds other rays";
    for (const std::uint16_t least : std::initializer_list<std::uint16_t>{1, 3, 10}) {
      if (!device_candidates(least)) return "it fails at the candidates";
      cpu_candidates(least);
      if (cpu_.refused != other_.refused || !same<Candidate>(cpu_.candidates, other_.candidates))
        return "it finds other candidates";
      for (std::size_t i = least; i < taken_.size(); i += 3) taken_[i] = 1;
    }
    return compare_particles();
  }
  // Two frames at once; then ever fewer rows of one, until the device is sure.
  std::string compare_particles() {
    cpu_particles();
    if (!device_.submit(image_, kLeast, kRounds) || !device_.submit(image_, kLeast, kRounds))
      return "it takes no frames";
    for (int frame = 0; frame < 2; ++frame) {
      if (!device_.collect(other_frame_)) return "it fails at a frame";
      if (other_frame_.lit_pixels != cpu_.found || other_frame_.rays != cpu_.rays.size ||
          (other_particles_.sure && !same(explain_.particles(), other_particles_.found)))
        return "it finds other particles in a frame";
    }
    do {
      if (!device_rays() || !device_particles()) return "it fails at the particles";
    } while (!other_particles_.sure && (used_ /= 2) > 0);
    cpu_rays(), cpu_particles();
    if (!other_particles_.sure) return "it is unsure of all particles";
    return same(explain_.particles(), other_particles_.found) ? "" : "it finds other particles";
  }
  void time(DeviceTrial& trial) {
    use_all();
    time_trial(
        trial, [&] { cpu_lit(), cpu_rays(), cpu_particles(); },
        [&] { device_.submit(image_, kLeast, kRounds) && device_.collect(other_frame_); });
  }

 private:
  std::span<const std::uint32_t> lit() const { return {cpu_.lit.data(), used_}; }

  void use_all() { used_ = std::min(cpu_.found, cpu_.lit.size()); }
  void cpu_lit() { cpu_.found = find_lit_pixels(image_, limit_, cpu_.lit); }
  void cpu_rays() { cpu_.refused = plan_.pixels_to_rays.convert(lit(), cpu_.rays); }
  void cpu_candidates(std::uint16_t least) {
    cpu_.candidates.clear();
    counter_.count(cpu_.rays, taken_, least);
    cpu_.refused = maxima_.find(counter_, least, cpu_.candidates);
  }
  void cpu_particles() {
    explain_.begin(cpu_.rays);
    for (std::size_t round = 0; round < kRounds; ++round) {
      std::copy(explain_.taken().begin(), explain_.taken().end(), taken_.begin());
      cpu_candidates(kLeast);
      if (explain_.explain(cpu_.rays, cpu_.candidates) == 0) break;
    }
    explain_.settle(cpu_.rays);
  }
  bool device_particles() { return device_.find_particles(kLeast, kRounds, other_particles_); }
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
  std::size_t used_ = 0;  // lit pixels whose rays are taken
  RayCounter counter_;
  CoarseMaxima maxima_;
  ExplainAway explain_;
  DeviceFrame other_frame_;
  DeviceParticles& other_particles_ = other_frame_.particles;
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
