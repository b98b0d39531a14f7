// SPDX-License-Identifier: MIT
// The two ends of the live stream over ZeroMQ: XPUB sends [topic][bytes] to whoever asked for the topic, SUB receives.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "proto/wire.hpp"

namespace rptv {

struct PublishOptions {
  std::vector<std::string> endpoints;  ///< ipc:///path, ipc://@abstract, tcp://host:port (port * : any)
  std::string curve_secret_key;        ///< Z85; empty: no CURVE. Applies to TCP endpoints only
  int high_water_mark = 100;           ///< messages that wait per subscriber
  int linger_ms = 500;                 ///< how long destruction goes on sending what waits
};

/// `queue_full`: sent, but at least one subscriber's queue was just found full and lost it. libzmq tells this for the
/// first message of a run of losses only; each subscriber counts its own losses exactly by Envelope.sequence.
enum class Sent : std::uint8_t { sent, queue_full, failed };

/// One thread at a time. A full or slow subscriber never makes send() wait and never costs another one a message:
/// libzmq drops what does not fit into that subscriber's own queue. libzmq copies the bytes into a block that it
/// allocates.
class PublishChannel {
 public:
  /// Binds all endpoints. Throws Error: unavailable (address in use), permission, configuration (malformed, missing
  /// directory, path that is no socket, TCP beyond loopback without CURVE).
  explicit PublishChannel(const PublishOptions& options);
  ~PublishChannel();
  PublishChannel(const PublishChannel&) = delete;
  PublishChannel& operator=(const PublishChannel&) = delete;

  /// Takes in what subscribers asked for since the last call. Returns a bit (1 << topic) per topic that somebody newly
  /// subscribed to, so that a late subscriber can be given what it missed.
  std::uint32_t poll_subscriptions() noexcept;
  bool subscribed(Topic topic) const noexcept;
  Sent send(Topic topic, std::span<const std::byte> bytes) noexcept;

  /// As bound, wildcards resolved.
  const std::vector<std::string>& endpoints() const noexcept { return endpoints_; }

 private:
  struct Socket;
  std::unique_ptr<Socket> socket_;
  std::vector<std::string> endpoints_;
};

struct SubscribeOptions {
  std::string endpoint;
  std::vector<Topic> topics{Topic::tracks};
  std::string curve_server_key;  ///< the publisher's public key, Z85; empty: no CURVE
  int high_water_mark = 100;
};

/// One thread at a time. Connecting succeeds before there is a publisher; libzmq reconnects by itself.
class SubscribeChannel {
 public:
  /// Throws Error(configuration) for an endpoint that cannot be one.
  explicit SubscribeChannel(const SubscribeOptions& options);
  ~SubscribeChannel();
  SubscribeChannel(const SubscribeChannel&) = delete;
  SubscribeChannel& operator=(const SubscribeChannel&) = delete;

  /// Waits up to `timeout_ms` (0: not at all) for the next message. False on timeout or when a signal came. `body` is
  /// valid until the next call. What is not of form [topic][bytes] is skipped and counted.
  bool receive(Topic& topic, std::span<const std::byte>& body, int timeout_ms);
  std::uint64_t malformed() const noexcept { return malformed_; }

 private:
  struct Socket;
  std::unique_ptr<Socket> socket_;
  std::uint64_t malformed_ = 0;
};

}  // namespace rptv
