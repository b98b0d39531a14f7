// SPDX-License-Identifier: MIT
// The same lists for two MultiViews, of which one has the device.
#include "reconstruct/multi_view/match_trial.hpp"

#include <algorithm>
#include <iterator>
#include <random>
#include <tuple>
#include <vector>

#include "reconstruct/multi_view/multi_view.hpp"

namespace rptv {

namespace {

/// Of somebody who keeps it.
class BorrowedMatcher final : public MatchDevice {
 public:
  explicit BorrowedMatcher(MatchDevice& device) : device_(device) {}
  bool match(std::span<const Detections> seen, std::span<const ViewMatch>& matches,
             CorrespondenceCounts& counts) noexcept override {
    return device_.match(seen, matches, counts);
  }
  std::span<const SeenView> views() const noexcept override { return device_.views(); }

 private:
  MatchDevice& device_;
};

/// A tenth of the views of a point is missing; coordinates are wrong by a fifth of the tolerance.
std::vector<Detections> seen_points(const MatchDevicePlan& plan) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> chance(0, 1);
  std::normal_distribution<double> error_px(0, plan.settings.tolerance_px / 5);
  const auto room = static_cast<std::size_t>(plan.settings.detector.max_detections);
  std::vector<Detections> seen;
  for (std::size_t c = 0; c < plan.cameras.size(); ++c) seen.emplace_back(room);
  for (std::size_t p = 0; p < std::clamp<std::size_t>(room / 2, 1, 1000); ++p) {
    Point3 at_mm;
    for (std::size_t k = 0; k < 3; ++k)
      at_mm[k] = plan.volume.from[k] + chance(random) * (plan.volume.to[k] - plan.volume.from[k]);
    for (std::size_t c = 0; c < plan.cameras.size(); ++c) {
      const CameraModel& camera = plan.rig.cameras[c].model;
      const auto pixel = camera.project(at_mm);
      if (chance(random) > 0.1 && pixel && camera.in_image(*pixel))
        seen[c].push({(*pixel)[0] + error_px(random), (*pixel)[1] + error_px(random), 0.1, 1000, 9});
    }
  }
  return seen;
}

auto sorted_rows(const Particles& of) {
  std::vector<std::tuple<double, double, double, double, double, Covariance, double>> rows;
  for (std::size_t i = 0; i < of.size(); ++i)
    rows.emplace_back(of.x_mm[i], of.y_mm[i], of.z_mm[i], of.residual_mm[i], of.support[i], of.covariance_mm2[i],
                      of.ghost[i]);
  std::sort(rows.begin(), rows.end());
  return rows;
}

bool same_but_one_in_fifty(const Particles& a, const Particles& b) {
  const auto of_a = sorted_rows(a), of_b = sorted_rows(b);
  auto both = of_a;
  both.erase(std::set_intersection(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(), both.begin()), both.end());
  const std::size_t most = std::max(of_a.size(), of_b.size());
  return 50 * (most - both.size()) <= most;
}

}  // namespace

DeviceTrial try_device(MatchDevice& device, const MatchDevicePlan& plan) {
  const auto seen = seen_points(plan);
  MultiView cpu(plan.settings, plan.rig, plan.cameras);
  MultiView other(plan.settings, plan.rig, plan.cameras, {},
                  [&](const MatchDevicePlan&) { return std::make_unique<BorrowedMatcher>(device); });
  const auto room = static_cast<std::size_t>(plan.settings.max_particles);
  Particles expected(room), found(room);
  cpu.reconstruct(seen, expected);
  other.reconstruct(seen, found);
  DeviceTrial trial;
  if (other.sets_without_device() > 0)
    trial.differs = "it fails";
  else if (!same_but_one_in_fifty(expected, found))
    trial.differs = "it finds other particles";
  else
    time_trial(
        trial, [&] { cpu.reconstruct(seen, expected); }, [&] { other.reconstruct(seen, found); });
  return trial;
}

}  // namespace rptv
