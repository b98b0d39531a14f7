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

/// Images that were sent; the one under way at a kill may have left or not.
struct Sent {
  std::uint64_t least = 0, most = 0;
  void add(const GvspTruth& truth) {
    least += truth.sent;
    most += truth.begun;
  }
};

void print(const Sent& sent, Rig& rig, const LatencyHistogram& back, std::uint64_t uncounted) {
  const auto number = [](std::uint64_t n) { return static_cast<unsigned long long>(n); };
  std::printf(
      "%llu kills, back after P50 %.0f ms, max %.0f ms; sent %llu to %llu, came %llu, counted %llu, uncounted %llu, "
      "wrong %llu; estimated for the outages %llu\n",
      number(back.count()), static_cast<double>(back.percentile_ns(0.5)) * 1e-6,
      static_cast<double>(back.max_ns()) * 1e-6, number(sent.least), number(sent.most), number(rig.received().images),
      number(rig.lost()), number(uncounted), number(rig.received().wrong), number(rig.estimated()));
  std::fflush(stdout);
}

int soak(double minutes) {
  AravisSettings settings = settings_for(kAddress);
  settings.region = {0, 0, 512, 512};
  auto camera = std::make_unique<CameraProcess>(kAddress, 1);
  Rig rig(settings);
  Sent sent;
  LatencyHistogram back;
  const std::int64_t end_ns = host_now_ns() + static_cast<std::int64_t>(minutes * 60e9);
  for (std::uint64_t session = 2; host_now_ns() < end_ns; ++session) {
    const std::int64_t kill_ns = std::min(host_now_ns() + kKill_ns, end_ns);
    rig.take_until([&] { return host_now_ns() >= kill_ns; });
    camera->kill();
    sent.add(camera->truth());
    camera = std::make_unique<CameraProcess>(kAddress, session);
    if (!rig.take_until([&] { return CameraProcess::session_of(rig.received().newest) == session; })) {
      std::printf("the camera did not come back: %s\n", rig.status().problem.c_str());
      return 1;
    }
    back.record(host_now_ns() - camera->truth().first_answer_ns);
    print(sent, rig, back, 0);
  }
  camera->rest();
  sent.add(camera->truth());
  const std::uint64_t last_image = rig.received().newest >> 32 << 32 | camera->truth().sent;
  rig.take_until([&] { return rig.accounted() >= sent.least || rig.received().newest == last_image; });
  const std::uint64_t uncounted = sent.least - std::min(sent.least, rig.accounted());
  print(sent, rig, back, uncounted);
  return uncounted == 0 && rig.accounted() <= sent.most && rig.received().wrong == 0 ? 0 : 1;
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
