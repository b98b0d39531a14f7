// SPDX-License-Identifier: MIT
// `rapidptv tail`: prints the live stream as lines for people or JSON for scripts.
#include <fmt/format.h>

#include <csignal>
#include <iostream>

#include "core/clock.hpp"
#include "daemon/commands/command.hpp"
#include "proto/channel.hpp"
#include "proto/encode.hpp"
#include "proto/endpoint.hpp"
#include "proto/text.hpp"

namespace rptv {
namespace {

constexpr int kLookMs = 100;  // between looks at signals and time-outs
constexpr std::int64_t kHintNs = 2'000'000'000;

struct TailOptions {
  std::string endpoint;
  std::vector<std::string> topics{"tracks"};
  std::string server_key;
  std::uint64_t count = 0;
  double timeout_s = 0;
  bool json = false;
  bool latency = false;
};

volatile std::sig_atomic_t interrupted = 0;
void interrupt(int) { interrupted = 1; }

void stop_on_signals() {
  struct sigaction action {};
  action.sa_handler = interrupt;  // no SA_RESTART: a waiting receive returns
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

SubscribeOptions subscription(const TailOptions& options) {
  SubscribeOptions subscribe;
  subscribe.endpoint = options.endpoint.empty() ? endpoint_to_watch() : options.endpoint;
  subscribe.curve_server_key = options.server_key;
  subscribe.topics.clear();
  for (std::size_t t = 0; t < kTopicCount; ++t)
    for (const std::string& topic : options.topics)
      if (topic == name_of(static_cast<Topic>(t))) subscribe.topics.push_back(static_cast<Topic>(t));
  return subscribe;
}

/// Prints messages until enough came, nothing more comes, or a signal says stop.
class Tail {
 public:
  explicit Tail(const TailOptions& options)
      : options_(options), subscription_(subscription(options)), channel_(subscription_), boot_id_(read_boot_id()) {}

  ExitCode run() {
    const auto timeout_ns = static_cast<std::int64_t>(options_.timeout_s * 1e9);
    const std::int64_t start_ns = host_now_ns();
    std::int64_t last_ns = start_ns;
    while (interrupted == 0 && std::cout && (options_.count == 0 || printed_ < options_.count)) {
      if (next()) {
        last_ns = host_now_ns();
        continue;
      }
      const std::int64_t silent_ns = host_now_ns() - last_ns;
      if (printed_ == 0 && !hinted_ && silent_ns > kHintNs) hint();
      if (timeout_ns > 0 && silent_ns >= timeout_ns) break;
    }
    if (printed_ == 0 && interrupted == 0 && std::cout) throw nothing_came();
    finish();
    return ExitCode::ok;
  }

 private:
  bool next() {
    Topic topic{};
    std::span<const std::byte> body;
    if (!channel_.receive(topic, body, kLookMs)) return false;
    const std::int64_t now_ns = host_now_ns();
    WireMessage message;
    if (const std::string fault = decode(body, message); !fault.empty())
      throw Error(ExitCode::bad_data, subscription_.endpoint + ": " + fault);
    const std::int64_t received_ns = message.boot_id == boot_id_ ? now_ns : 0;
    latency_.record(message, received_ns);
    const std::uint64_t missing = sequence_.missing_before(topic, message);
    if (missing != 0)
      std::cerr << fmt::format("rapidptv: {} messages on topic {} lost: this reader is too slow\n", missing,
                               name_of(topic));
    std::cout << (options_.json ? to_json(message, received_ns) : to_line(message, received_ns)) << std::endl;
    ++printed_;
    return true;
  }

  void hint() {
    hinted_ = true;
    std::cerr << fmt::format("rapidptv: waiting for {} (Ctrl-C ends)\n", subscription_.endpoint);
  }

  Error nothing_came() const {
    return {ExitCode::unavailable, fmt::format("{}: nothing came within {:g} s; start `rapidptv run`, or name the "
                                               "endpoint that it prints",
                                               subscription_.endpoint, options_.timeout_s)};
  }

  void finish() const {
    if (options_.latency) std::cout << (options_.json ? latency_.json() + "\n" : latency_.table()) << std::flush;
    if (sequence_.missing() != 0)
      std::cerr << fmt::format("rapidptv: {} messages printed, {} lost\n", printed_, sequence_.missing());
  }

  const TailOptions& options_;
  SubscribeOptions subscription_;
  SubscribeChannel channel_;
  std::string boot_id_;
  ReceivedLatency latency_;
  SequenceCheck sequence_;
  std::uint64_t printed_ = 0;
  bool hinted_ = false;
};

}  // namespace

void add_tail(Command app, Action& chosen) {
  auto options = std::make_shared<TailOptions>();
  Command command = app.add_subcommand("tail", "Print the live stream of a running rapidptv");
  command.add_option("endpoint", options->endpoint,
                     "where it publishes (default: the service's socket, else your own)");
  command.add_option("--topic", options->topics, "what to print; several separated by commas")
      .delimiter(',')
      .one_of({"tracks", "particles", "status", "rig"})
      .show_default();
  command.add_flag("--json", options->json, "one JSON object per line with all data (mm, mm/s, ns)");
  command.add_option("--count", options->count, "end after this many messages");
  command
      .add_option("--timeout", options->timeout_s,
                  "end when nothing comes for this many seconds; 69 if nothing came at all")
      .positive();
  command.add_flag("--latency", options->latency,
                   "at the end, print P50, P99, P99.9 and max from exposure end to each stage");
  command.add_option("--server-key", options->server_key, "public CURVE key of the publisher (TCP beyond loopback)");
  command.footer(
      "Examples:\n"
      "  rapidptv tail\n"
      "  rapidptv tail --topic status\n"
      "  rapidptv tail tcp://127.0.0.1:5555 --json --count 100 | jq .x\n"
      "  rapidptv tail --latency --count 1000 --timeout 5");
  command.callback([options, &chosen] {
    chosen = [options] {
      stop_on_signals();
      return Tail(*options).run();
    };
  });
}

}  // namespace rptv
