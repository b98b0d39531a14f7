// SPDX-License-Identifier: MIT
// The publisher's thread: takes results, encodes what somebody subscribed to, sends it, and reports status.
#include "daemon/publisher.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>

#include "core/clock.hpp"
#include "proto/channel.hpp"
#include "proto/encode.hpp"
#include "proto/endpoint.hpp"

namespace rptv {
namespace {

constexpr std::int64_t kIdleNs = 20'000'000;  // longest time until a new subscriber is noticed

PublishOptions options_of(const PublisherSettings& settings) {
  PublishOptions options;
  if (settings.endpoint.empty()) {
    make_default_directory();
    options.endpoints = {default_endpoint()};
  } else {
    options.endpoints = split_endpoints(settings.endpoint);
  }
  if (!settings.curve_secret_key_file.empty())
    options.curve_secret_key = read_curve_key(settings.curve_secret_key_file);
  options.high_water_mark = static_cast<int>(settings.high_water_mark);
  return options;
}

using StageHistograms = std::array<LatencyHistogram, kStageCount>;

void record(StageHistograms& histograms, const Stamps& stamps) noexcept {
  const std::int64_t from_ns = stamps[Stage::exposure_end];
  for (std::size_t i = 1; i < kStageCount && from_ns != 0; ++i)
    if (stamps.at_ns[i] != 0) histograms[i].record(stamps.at_ns[i] - from_ns);
}

}  // namespace

struct Publisher::Running {
  Running(const PublisherSettings& settings, PublisherContent fixed, Losses& losses, FillStatus fill)
      : content(std::move(fixed)),
        fill_status(std::move(fill)),
        status_period_ns(settings.status_period_ms * 1'000'000),
        encoder(make_session_name(), content.particle_capacity, content.track_capacity),
        queue(Bounded{static_cast<std::size_t>(settings.queue_depth)}, losses, LossCause::publish_backlog),
        channel(options_of(settings)) {}

  void run() noexcept;
  void publish_one(ResultLease&& result) noexcept;
  void welcome(std::uint32_t newly_subscribed) noexcept;
  void renew_status() noexcept;
  void send_status() noexcept;
  void send(Topic topic, std::span<const std::byte> bytes) noexcept;

  const PublisherContent content;
  const FillStatus fill_status;
  const std::int64_t status_period_ns;
  Encoder encoder;
  HandOver<ResultLease> queue;
  PublishChannel channel;
  std::atomic<std::uint64_t> frames{0};
  std::atomic<bool> has_subscriber{false};
  std::thread thread;
  // The publisher's thread only, until it has ended.
  std::uint64_t messages_sent = 0;
  std::uint64_t queue_full = 0;
  StatusReport report;
  StageHistograms whole_run;
  StageHistograms this_period;
};

void Publisher::Running::send(Topic topic, std::span<const std::byte> bytes) noexcept {
  const Sent sent = channel.send(topic, bytes);
  if (sent != Sent::failed) ++messages_sent;
  if (sent == Sent::queue_full) ++queue_full;
}

void Publisher::Running::publish_one(ResultLease&& result) noexcept {
  const ResultLease lease = std::move(result);
  Stamps stamps = lease->stamps;  // the result is shared with other readers: its own stamps must not change
  if (channel.subscribed(Topic::tracks))
    send(Topic::tracks, encoder.tracks(*lease, stamps));
  else
    stamps[Stage::published] = host_now_ns();
  Stamps particle_stamps = lease->stamps;
  if (channel.subscribed(Topic::particles)) send(Topic::particles, encoder.particles(*lease, particle_stamps));
  record(whole_run, stamps);
  record(this_period, stamps);
  frames.fetch_add(1, std::memory_order_relaxed);
}

/// Status and rig are built once per period or per subscriber and may allocate; when memory is out they are skipped.
void Publisher::Running::send_status() noexcept {
  try {
    if (channel.subscribed(Topic::status)) send(Topic::status, encoder.status(report));
  } catch (const std::exception&) {
  }
}

void Publisher::Running::renew_status() noexcept {
  report.clear();
  try {
    if (fill_status) fill_status(report);
  } catch (const std::exception&) {
  }
  report.messages_sent = messages_sent;
  report.queue_full = queue_full;
  for (std::size_t i = 1; i < kStageCount; ++i) report.latency[i] = summary_of(this_period[i]);
  for (auto& histogram : this_period) histogram = {};
}

void Publisher::Running::welcome(std::uint32_t newly_subscribed) noexcept {
  const auto asked = [newly_subscribed](Topic topic) {
    return (newly_subscribed >> static_cast<unsigned>(topic) & 1U) != 0;
  };
  if (asked(Topic::status)) send_status();
  if (!asked(Topic::rig)) return;
  try {
    send(Topic::rig, encoder.rig(content.calibration_text, content.config_text));
  } catch (const std::exception&) {
  }
}

void Publisher::Running::run() noexcept {
  renew_status();
  std::int64_t next_status_ns = host_now_ns() + status_period_ns;
  ResultLease result;
  while (true) {
    const Taken taken = queue.pop(result, std::min(kIdleNs, status_period_ns));
    welcome(channel.poll_subscriptions());
    has_subscriber.store(channel.subscribed(Topic::tracks), std::memory_order_relaxed);
    if (taken == Taken::value) publish_one(std::move(result));
    if (taken == Taken::closed) break;
    if (host_now_ns() < next_status_ns) continue;
    renew_status();
    send_status();
    next_status_ns = host_now_ns() + status_period_ns;
  }
  renew_status();
  send_status();
}

Publisher::Publisher(const PublisherSettings& settings, PublisherContent content, Losses& losses,
                     FillStatus fill_status)
    : running_(std::make_unique<Running>(settings, std::move(content), losses, std::move(fill_status))) {}

Publisher::~Publisher() { stop(); }

void Publisher::start() {
  running_->thread = std::thread([running = running_.get()] { running->run(); });
}

void Publisher::stop() noexcept {
  running_->queue.close();
  if (running_->thread.joinable()) running_->thread.join();
}

bool Publisher::publish(ResultLease&& result) noexcept {
  ResultLease lease = std::move(result);
  return running_->queue.push(std::move(lease));
}

const std::vector<std::string>& Publisher::endpoints() const noexcept { return running_->channel.endpoints(); }
bool Publisher::has_subscriber() const noexcept { return running_->has_subscriber.load(std::memory_order_relaxed); }
std::size_t Publisher::waiting() const noexcept { return running_->queue.waiting(); }
std::uint64_t Publisher::frames_published() const noexcept { return running_->frames.load(std::memory_order_relaxed); }
const std::array<LatencyHistogram, kStageCount>& Publisher::latency() const noexcept { return running_->whole_run; }

}  // namespace rptv
