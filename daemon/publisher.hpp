// SPDX-License-Identifier: MIT
// Sends results and status to whoever subscribes, on a thread of its own that nobody waits for.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/hand_over.hpp"
#include "core/result.hpp"
#include "core/settings.hpp"
#include "proto/status.hpp"

namespace rptv {

struct PublisherSettings {
  std::string endpoint;
  std::string curve_secret_key_file;
  std::int64_t high_water_mark = 100;
  std::int64_t queue_depth = 8;
  std::int64_t status_period_ms = 1000;

  void fields(FieldList& list) {
    list.text("endpoint", endpoint,
              "where subscribers connect: ipc:///path or tcp://127.0.0.1:5555, several separated by commas; empty: "
              "tracks.sock in $RUNTIME_DIRECTORY, else in $XDG_RUNTIME_DIR/rapidptv, else in /tmp/rapidptv-<uid>");
    list.text("curve_secret_key_file", curve_secret_key_file,
              "file with the server's secret CURVE key (40 characters, Z85), needed for TCP beyond loopback");
    list.integer("high_water_mark", high_water_mark, 1, 1'000'000,
                 "messages that wait for one slow subscriber before it loses further ones");
    list.integer("queue_depth", queue_depth, 1, 4096,
                 "results that wait for the publisher before the next is lost as publish_backlog");
    list.integer("status_period_ms", status_period_ms, 10, 3'600'000, "time between two status messages, ms");
  }
};

/// Sizes and texts that are fixed for the whole run.
struct PublisherContent {
  std::size_t particle_capacity = 0;  ///< of every Result that will be published
  std::size_t track_capacity = 0;
  std::string calibration_text;  ///< sent on topic `rig` to every subscriber as it joins
  std::string config_text;
};

/// Adds what the pipeline knows to a cleared report; runs on the publisher's thread once per status period. The
/// publisher itself fills latency, messages_sent and queue_full.
using FillStatus = std::function<void(StatusReport&)>;

/// Construction binds the endpoint and takes all memory; throws Error (see PublishChannel). start and stop: one thread.
class Publisher {
 public:
  /// `losses` counts publish_backlog and must outlive the publisher.
  Publisher(const PublisherSettings& settings, PublisherContent content, Losses& losses, FillStatus fill_status);
  ~Publisher();
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;

  void start();
  /// Sends what waits and a last status, then ends the thread. Idempotent.
  void stop() noexcept;

  /// One producer thread. Never waits: false, counted as publish_backlog, when queue_depth results wait already. The
  /// lease is given back as soon as the result is encoded.
  bool publish(ResultLease&& result) noexcept;

  /// Where it is bound, with wildcards resolved.
  const std::vector<std::string>& endpoints() const noexcept;
  /// Somebody asked for tracks. Any thread; noticed within 20 ms.
  bool has_subscriber() const noexcept;
  std::size_t waiting() const noexcept;             ///< any thread
  std::uint64_t frames_published() const noexcept;  ///< any thread; results taken off the queue
  /// Exposure end to each stage over the whole run. Valid after stop(), or inside FillStatus.
  const std::array<LatencyHistogram, kStageCount>& latency() const noexcept;

 private:
  struct Running;
  std::unique_ptr<Running> running_;
};

}  // namespace rptv
