// SPDX-License-Identifier: MIT
// A configuration's own images through its reconstruction on the GPU, stage by stage.
#include "daemon/commands/bench_cuda.hpp"

#include <iostream>

#include "daemon/backend.hpp"
#include "daemon/config.hpp"
#include "daemon/device_bench.hpp"
#include "daemon/each_frame_set.hpp"
#include "daemon/session.hpp"
#include "reconstruct/cuda_probe.hpp"

namespace rptv {

ExitCode bench_cuda(const CudaBenchOptions& options) {
  if (const CudaProbe probe = probe_cuda(); !probe.usable)
    throw Error(ExitCode::unavailable, "bench --cuda: " + probe.text + "; without --cuda the CPU is timed");
  std::vector<std::string> set = options.set;
  set.push_back("reconstruction.backend=\"cuda\"");
  const Config config = load_config(options.config, set);
  auto source = make_source(config);
  Intake intake(source->cameras(), IntakeOptions{.policy = Lossless{8}});
  StageTimer timer;
  auto reconstructor = make_reconstructor(config, source->cameras());
  bool locked = true;
  for (std::uint32_t c = 0; c < intake.cameras(); ++c)
    locked = reconstructor->page_lock(intake.frame_memory(c)) && locked;
  if (!locked) std::cerr << "rapidptv: frames could not be page-locked; uploads are slower: raise `ulimit -l`\n";

  DeviceBench bench(timer);
  Particles particles(config.max_particles());
  bool warm = false;
  for_each_frame_set(*source, intake, [&](const FrameSet& frames) {
    if (!std::exchange(warm, true)) reconstructor->reconstruct(frames, particles);
    for (int round = 0; round < options.rounds; ++round)
      bench.round([&] { reconstructor->reconstruct(frames, particles); });
  });
  if (!warm) throw Error(ExitCode::bad_data, options.config + ": its source gave no frame; see rapidptv check");
  if (const std::uint64_t sets = reconstructor->sets_without_device(); sets > 0)
    throw Error(ExitCode::unavailable, "bench --cuda: " + device_failure(sets));
  const CudaDeviceLimits limits = ask_cuda_device_limits();
  (options.json ? std::cerr : std::cout) << to_text(bench.result(), limits);
  if (options.json) std::cout << to_json(bench.result(), limits);
  return ExitCode::ok;
}

}  // namespace rptv
