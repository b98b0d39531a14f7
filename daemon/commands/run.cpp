// SPDX-License-Identifier: MIT
// `rapidptv run`: the daemon in the foreground, as a service or by hand.
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <fstream>
#include <iostream>

#include "daemon/commands/command.hpp"
#include "daemon/config.hpp"
#include "daemon/first_instant.hpp"
#include "daemon/log.hpp"
#include "daemon/session.hpp"
#include "daemon/supervisor.hpp"

namespace rptv {
namespace {

constexpr std::int64_t kPollNs = 100'000'000;

struct RunOptions {
  std::string config, tracks, points, endpoint, report, log_level, backend;
  std::vector<std::string> set;
  bool wait_for_subscriber = false;
};

Config resolve(const RunOptions& options) {
  Config config = load_config(options.config, options.set);
  if (!options.tracks.empty()) config.output.tracks = options.tracks;
  if (!options.points.empty()) config.output.points = options.points;
  if (!options.endpoint.empty()) config.publisher.endpoint = options.endpoint;
  if (!options.backend.empty()) config.reconstruction.backend = options.backend;
  return config;
}

void write_report(const SessionReport& report, const std::string& file) {
  if (spdlog::should_log(spdlog::level::info)) std::cerr << to_text(report);
  if (file.empty()) return;
  std::ofstream out(file);
  out << to_json(report) << '\n';
  if (!out.flush()) throw Error(ExitCode::io, file + ": cannot write the report; check the folder and the disk");
}

/// What the recording's first images look like; what cannot be read, the session tells.
void warn_of_first_instant(const Config& config) try {
  for (const std::string& doubt : doubts_of_first_instant(config)) spdlog::warn("{}", doubt);
} catch (const Error&) {
}

ExitCode run(const RunOptions& options) {
  start_log(options.log_level);
  const Config config = resolve(options);
  Supervisor supervisor;
  warn_of_first_instant(config);
  Session session(config);
  spdlog::info("{}", session.backend());
  for (const std::string& endpoint : session.endpoints()) spdlog::info("publishing at {}", endpoint);
  if (options.wait_for_subscriber) {
    spdlog::info("waiting for a subscriber");
    while (!session.has_subscriber())
      if (supervisor.wait(kPollNs / 10)) return ExitCode::ok;
  }
  session.start();
  supervisor.ready();
  const bool terminal = isatty(STDERR_FILENO) != 0;
  std::int64_t next_summary_ns = host_now_ns();
  while (!supervisor.wait(kPollNs) && !session.finished()) {
    supervisor.progress(session.counts().linked, session.idle());
    if (host_now_ns() < next_summary_ns) continue;
    next_summary_ns += 1'000'000'000;
    const std::string line = session.summary();
    supervisor.status(line);
    if (terminal) std::cerr << "\r\033[K" << line << std::flush;
  }
  if (terminal) std::cerr << "\r\033[K";
  supervisor.stopping();
  session.stop();
  const SessionReport report = session.report();
  write_report(report, options.report);
  if (report.source_failure.empty()) return ExitCode::ok;
  throw Error(ExitCode::io, report.source_failure);
}

}  // namespace

void add_run(Command app, Action& chosen) {
  auto options = std::make_shared<RunOptions>();
  Command command = app.add_subcommand("run", "Take frames, find and link particles, publish tracks");
  command.add_option("-c,--config", options->config, "configuration (TOML)").required();
  command.add_option("--set", options->set, "override one setting: key=value").allow_extra_args(false);
  command.add_option("--tracks", options->tracks, "also write tracks to this CSV file");
  command.add_option("--points", options->points, "also write particles to this CSV file");
  command.add_option("--endpoint", options->endpoint, "publish here instead of publisher.endpoint");
  command.add_option("--backend", options->backend, "processor that reconstructs, instead of reconstruction.backend")
      .one_of({"auto", "cuda", "cpu"});
  command.add_option("--report", options->report, "write the final report to this JSON file");
  command.add_option("--log-level", options->log_level, "trace, debug, info, warning, error or off");
  command.add_flag("--wait-for-subscriber", options->wait_for_subscriber,
                   "let frames flow only once somebody has subscribed to tracks");
  command.footer(
      "Ctrl-C or SIGTERM drains and exits 0; a second Ctrl-C stops at once.\n"
      "Examples:\n"
      "  rapidptv run --config rig.toml\n"
      "  rapidptv run --config rig.toml --tracks tracks.csv --set linker.search_range_mm=0.3\n"
      "  rapidptv run --config rig.toml --set replay.speed=0 --set intake.policy=lossless --tracks tracks.csv");
  command.callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

}  // namespace rptv
