// SPDX-License-Identifier: MIT
// A GigE camera that is killed every 30 s for as long as wanted: what was sent against what came or was counted.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>

#include "core/latency.hpp"
#include "tests/acquisition/aravis_rig.hpp"
#include "tests/acquisition/camera_process.hpp"

namespace rptv {
namespace {

constexpr const char* kAddress = "127.0.23.1";
constexpr std::int64_t kKill_ns = 30'000'000'000;

void print(Rig& rig, const LatencyHistogram& back, std::uint64_t uncounted) {
  const auto number = [](std::uint64_t n) { return static_cast<unsigned long long>(n); };
  std::printf(
      "%llu kills, back after P50 %.0f ms, max %.0f ms; sent %llu to %llu, came %llu, counted %llu, uncounted %llu, "
      "wrong %llu; estimated for the outages %llu, next to them %llu of those sent\n",
      number(back.count()), static_cast<double>(back.percentile_ns(0.5)) * 1e-6,
      static_cast<double>(back.max_ns()) * 1e-6, number(rig.lives().least()), number(rig.lives().most()),
      number(rig.received().images), number(rig.lost()), number(uncounted), number(rig.received().wrong),
      number(rig.estimated()), number(rig.lives().next_to_outages()));
  std::fflush(stdout);
}

int soak(double minutes) {
  AravisSettings settings = settings_for(kAddress);
  settings.region = {0, 0, 512, 512};
  auto camera = std::make_unique<CameraProcess>(kAddress, 1);
  Rig rig(settings);
  LatencyHistogram back;
  const std::int64_t end_ns = host_now_ns() + static_cast<std::int64_t>(minutes * 60e9);
  for (std::uint64_t session = 2; host_now_ns() < end_ns; ++session) {
    const std::int64_t kill_ns = std::min(host_now_ns() + kKill_ns, end_ns);
    rig.take_until([&] { return host_now_ns() >= kill_ns; });
    camera->kill();
    rig.lives().over(session - 1, camera->truth());
    camera = std::make_unique<CameraProcess>(kAddress, session);
    if (!rig.take_until([&] { return CameraProcess::session_of(rig.received().newest) == session; })) {
      std::printf("the camera did not come back: %s\n", rig.status().problem.c_str());
      return 1;
    }
    back.record(host_now_ns() - camera->truth().first_answer_ns);
    print(rig, back, 0);
  }
  camera->rest();
  rig.lives().over(rig.received().newest >> 32, camera->truth());
  const std::uint64_t last_image = rig.received().newest >> 32 << 32 | camera->truth().sent;
  rig.take_until([&] { return rig.accounted() >= rig.lives().least() || rig.received().newest == last_image; });
  const std::uint64_t known = rig.accounted() + rig.lives().next_to_outages();
  const std::uint64_t uncounted = rig.lives().least() - std::min(rig.lives().least(), known);
  print(rig, back, uncounted);
  return uncounted == 0 && rig.accounted() <= rig.lives().most() && rig.received().wrong == 0 ? 0 : 1;
}

}  // namespace
}  // namespace rptv

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: GVSP_CAMERA=BUILD/tests/acquisition/gvsp_camera rptv_soak_camera MINUTES\n");
    return 64;
  }
  try {
    return rptv::soak(std::atof(argv[1]));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 69;
  }
}
