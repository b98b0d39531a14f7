// SPDX-License-Identifier: MIT
// `rapidptv bench`: how long each stage takes on the user's own images, one stage at a time, without pacing.
#include <fmt/format.h>
#include <sys/utsname.h>

#include <fstream>
#include <iostream>
#include <thread>

#include "daemon/commands/bench_cuda.hpp"
#include "daemon/commands/command.hpp"
#include "daemon/config.hpp"
#include "daemon/each_frame_set.hpp"
#include "daemon/session.hpp"
#include "proto/encode.hpp"

namespace rptv {
namespace {

struct BenchOptions {
  std::string config;
  std::vector<std::string> set;
  bool json = false, cuda = false;
  int rounds = 5;
};

struct StageTimes {
  std::string_view name;
  LatencyHistogram histogram;
};

struct BenchRun {
  StageTimes reconstruct{"reconstruct", {}}, link{"link", {}}, encode{"encode tracks", {}}, all{"all stages", {}};
  std::uint64_t particles = 0, track_points = 0;
};

std::string processor() {
  std::ifstream cpuinfo("/proc/cpuinfo");
  for (std::string line; std::getline(cpuinfo, line);)
    if (line.rfind("model name", 0) == 0 && line.find(": ") != std::string::npos)
      return line.substr(line.find(": ") + 2);
  utsname name{};
  uname(&name);
  return name.machine;
}

BenchRun measure(const Config& config) {
  auto source = make_source(config);
  auto reconstructor = make_reconstructor(config, source->cameras());
  Linker linker(config.linker);
  const std::size_t max_particles = config.max_particles();
  Result result(max_particles, linker.capacity());
  Encoder encoder(make_session_name(), max_particles, linker.capacity());
  Intake intake(source->cameras(), IntakeOptions{.policy = Lossless{8}});
  BenchRun run;
  for_each_frame_set(*source, intake, [&](const FrameSet& frames) {
    const std::int64_t t0 = host_now_ns();
    reconstructor->reconstruct(frames, result.particles);
    const std::int64_t t1 = host_now_ns();
    linker.next(result.particles, frames.info().index, frames.info().exposure_end_ns, result.tracks);
    const std::int64_t t2 = host_now_ns();
    result.frame = frames.info().index;
    encoder.tracks(result, result.stamps);
    const std::int64_t t3 = host_now_ns();
    run.reconstruct.histogram.record(t1 - t0);
    run.link.histogram.record(t2 - t1);
    run.encode.histogram.record(t3 - t2);
    run.all.histogram.record(t3 - t0);
    run.particles += result.particles.size();
    run.track_points += result.tracks.size();
  });
  return run;
}

void print_text(const BenchRun& run) {
  const auto ms = [](std::int64_t ns) { return static_cast<double>(ns) * 1e-6; };
  const std::uint64_t frames = run.all.histogram.count();
  std::cout << fmt::format("{}, {} threads; {} frames, {:.1f} particles and {:.1f} track points a frame\n", processor(),
                           std::thread::hardware_concurrency(), frames,
                           static_cast<double>(run.particles) / static_cast<double>(frames),
                           static_cast<double>(run.track_points) / static_cast<double>(frames))
            << "stage, ms a frame            P50       P99     P99.9       max\n";
  for (const StageTimes* stage : {&run.reconstruct, &run.link, &run.encode, &run.all}) {
    const LatencyHistogram& h = stage->histogram;
    std::cout << fmt::format("  {:<20} {:>9.3f} {:>9.3f} {:>9.3f} {:>9.3f}\n", stage->name, ms(h.percentile_ns(0.5)),
                             ms(h.percentile_ns(0.99)), ms(h.percentile_ns(0.999)), ms(h.max_ns()));
  }
}

void print_json(const BenchRun& run) {
  std::cout << fmt::format(R"({{"frames":{},"particles":{},"track_points":{},"stages_ns":{{)",
                           run.all.histogram.count(), run.particles, run.track_points);
  const char* separator = "";
  for (const StageTimes* stage : {&run.reconstruct, &run.link, &run.encode, &run.all}) {
    const LatencyHistogram& h = stage->histogram;
    std::cout << fmt::format(R"({}"{}":{{"p50":{},"p99":{},"p99_9":{},"max":{}}})", separator, stage->name,
                             h.percentile_ns(0.5), h.percentile_ns(0.99), h.percentile_ns(0.999), h.max_ns());
    separator = ",";
  }
  std::cout << "}}\n";
}

ExitCode bench(const BenchOptions& options) {
  std::vector<std::string> set = options.set;
  set.insert(set.end(), {"replay.speed=0", "replay.preload=true", "replay.loop=1"});
  if (options.cuda) return bench_cuda({options.config, set, options.rounds, options.json});
  const BenchRun run = measure(load_config(options.config, set));
  if (run.all.histogram.count() == 0)
    throw Error(ExitCode::bad_data, options.config + ": its source gave no frame; see rapidptv check");
  options.json ? print_json(run) : print_text(run);
  return ExitCode::ok;
}

}  // namespace

void add_bench(Command app, Action& chosen) {
  auto options = std::make_shared<BenchOptions>();
  Command command = app.add_subcommand("bench", "Time each stage on a configuration's own images");
  command.add_option("-c,--config", options->config, "configuration (TOML)").required();
  command.add_option("--set", options->set, "override one setting: key=value").allow_extra_args(false);
  command.add_flag("--json", options->json,
                   "print one JSON object, times in ns; with --cuda, the table goes to stderr");
  Option cuda = command.add_flag("--cuda", options->cuda, "time the stages on the GPU, by its own events");
  command.add_option("--rounds", options->rounds, "with --cuda: how often each frame set is reconstructed")
      .range(1, 1000000)
      .needs(cuda)
      .show_default();
  command.footer(
      "Examples:\n  rapidptv bench --config demo-out/rig.toml\n  rapidptv bench --config rig.toml --set "
      "light_field.threads=1\n  rapidptv bench --config rig.toml --cuda --rounds 20 --json > gpu.json");
  command.callback([options, &chosen] { chosen = [options] { return bench(*options); }; });
}

}  // namespace rptv
