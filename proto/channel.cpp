// SPDX-License-Identifier: MIT
// XPUB and SUB sockets behind proto/channel.hpp; the only file that sees ZeroMQ.
#include "proto/channel.hpp"

#include <array>
#include <zmq.hpp>

#include "core/error.hpp"
#include "proto/endpoint.hpp"

namespace rptv {
namespace {

constexpr std::int64_t kMaxMessageBytes = std::int64_t{1} << 28;
constexpr int kSubscriptionsPerPoll = 256;  // a flood of requests must not keep the publisher from publishing

Error bind_error(const std::string& endpoint, const zmq::error_t& error) {
  switch (error.num()) {
    case EADDRINUSE:
      return {
          ExitCode::unavailable,
          endpoint + ": address already in use; stop the other program there, or choose another publisher.endpoint"};
    case EACCES:
    case EPERM:
      return {ExitCode::permission, endpoint +
                                        ": no permission to listen there; choose a port from 1024 on, a path that "
                                        "you may write, or another user"};
    default:
      return {ExitCode::configuration,
              endpoint + ": cannot listen there (" + error.what() + "); choose another publisher.endpoint"};
  }
}

/// Options that libzmq copies at bind or connect.
void set_ipv6(zmq::socket_t& socket, const Endpoint& endpoint) {
  socket.set(zmq::sockopt::ipv6, endpoint.transport == Endpoint::Transport::tcp && endpoint.address.starts_with('['));
}

void set_key(zmq::socket_t& socket, bool encrypted, const std::string& secret_key) {
  try {
    socket.set(zmq::sockopt::curve_server, encrypted);
    if (encrypted) socket.set(zmq::sockopt::curve_secretkey, secret_key);
  } catch (const zmq::error_t&) {
    throw Error(ExitCode::configuration,
                "the secret CURVE key is not 40 characters of Z85, or libzmq has no CURVE; docs/wire.md shows how to "
                "make one");
  }
}

}  // namespace

struct PublishChannel::Socket {
  zmq::context_t context{1};
  zmq::socket_t xpub{context, zmq::socket_type::xpub};
  zmq::message_t request;
  /// Bit n of element t: somebody subscribes to the first n characters of topic t (ZeroMQ subscribes to prefixes).
  std::array<std::uint32_t, kTopicCount> prefixes{};

  std::uint32_t take_in(std::string_view request_text) noexcept {
    const bool wanted = request_text[0] == 1;
    const std::string_view prefix = request_text.substr(1);
    std::uint32_t newly = 0;
    for (std::size_t t = 0; t < kTopicCount; ++t) {
      if (!name_of(static_cast<Topic>(t)).starts_with(prefix)) continue;
      const std::uint32_t bit = 1U << prefix.size();
      if (wanted) {
        prefixes[t] |= bit;
        newly |= 1U << t;
      } else {
        prefixes[t] &= ~bit;
      }
    }
    return newly;
  }

  bool send_both(Topic topic, std::span<const std::byte> bytes) {
    const std::string_view name = name_of(topic);
    const auto first =
        xpub.send(zmq::const_buffer(name.data(), name.size()), zmq::send_flags::sndmore | zmq::send_flags::dontwait);
    if (!first) return false;
    return xpub.send(zmq::const_buffer(bytes.data(), bytes.size()), zmq::send_flags::dontwait).has_value();
  }
};

PublishChannel::PublishChannel(const PublishOptions& options) : socket_(std::make_unique<Socket>()) {
  auto& xpub = socket_->xpub;
  xpub.set(zmq::sockopt::sndhwm, options.high_water_mark);
  xpub.set(zmq::sockopt::linger, options.linger_ms);
  xpub.set(zmq::sockopt::xpub_verbose, true);  // every late subscriber is told of, not only a topic's first
  for (const std::string& text : options.endpoints) {
    const Endpoint endpoint = parse_endpoint(text);
    if (!endpoint.local && options.curve_secret_key.empty())
      throw Error(ExitCode::configuration,
                  "endpoint '" + text +
                      "' is open to other machines without encryption; set publisher.curve_secret_key_file, or use "
                      "tcp://127.0.0.1:PORT and reach it by ssh -L PORT:127.0.0.1:PORT");
    const bool tcp = endpoint.transport == Endpoint::Transport::tcp;
    if (!tcp) check_ipc_path(endpoint);
    if (!options.curve_secret_key.empty()) set_key(xpub, tcp, options.curve_secret_key);
    set_ipv6(xpub, endpoint);
    try {
      xpub.bind(endpoint.text);
    } catch (const zmq::error_t& error) {
      throw bind_error(endpoint.text, error);
    }
    endpoints_.push_back(xpub.get(zmq::sockopt::last_endpoint));
  }
}

PublishChannel::~PublishChannel() = default;

std::uint32_t PublishChannel::poll_subscriptions() noexcept {
  std::uint32_t newly = 0;
  try {
    for (int i = 0; i < kSubscriptionsPerPoll; ++i) {
      if (!socket_->xpub.recv(socket_->request, zmq::recv_flags::dontwait)) break;
      const std::string_view text = socket_->request.to_string_view();
      if (!text.empty() && (text[0] == 0 || text[0] == 1)) newly |= socket_->take_in(text);
    }
  } catch (const zmq::error_t&) {  // interrupted by a signal: the next call goes on
  }
  return newly;
}

bool PublishChannel::subscribed(Topic topic) const noexcept {
  return socket_->prefixes[static_cast<std::size_t>(topic)] != 0;
}

Sent PublishChannel::send(Topic topic, std::span<const std::byte> bytes) noexcept {
  try {
    // With NODROP a full queue refuses the whole message before anybody got it: then it is known, and the message goes
    // out again without NODROP, to all but the slow one. Asking for events in between makes libzmq take in what readers
    // have read (it looks once per millisecond only), lest a quick one be taken for a slow one.
    socket_->xpub.set(zmq::sockopt::xpub_nodrop, true);
    if (socket_->send_both(topic, bytes)) return Sent::sent;
    (void)socket_->xpub.get(zmq::sockopt::events);
    if (socket_->send_both(topic, bytes)) return Sent::sent;
    socket_->xpub.set(zmq::sockopt::xpub_nodrop, false);
    return socket_->send_both(topic, bytes) ? Sent::queue_full : Sent::failed;
  } catch (const zmq::error_t&) {
    return Sent::failed;
  }
}

struct SubscribeChannel::Socket {
  zmq::context_t context{1};
  zmq::socket_t sub{context, zmq::socket_type::sub};
  zmq::message_t name;
  zmq::message_t body;

  /// Takes one message whole. False when none is there; `topic` is count_ when it is none of ours.
  bool take(Topic& topic) {
    if (!sub.recv(name, zmq::recv_flags::dontwait)) return false;
    topic = Topic::count_;
    bool more = name.more();
    int parts = 1;
    for (; more; ++parts) {
      (void)sub.recv(body);  // the parts of a message arrive together
      more = body.more();
    }
    for (std::size_t t = 0; t < kTopicCount && parts == 2; ++t)
      if (name.to_string_view() == name_of(static_cast<Topic>(t))) topic = static_cast<Topic>(t);
    return true;
  }
};

SubscribeChannel::SubscribeChannel(const SubscribeOptions& options) : socket_(std::make_unique<Socket>()) {
  const Endpoint endpoint = parse_endpoint(options.endpoint);
  auto& sub = socket_->sub;
  sub.set(zmq::sockopt::rcvhwm, options.high_water_mark);
  sub.set(zmq::sockopt::linger, 0);
  sub.set(zmq::sockopt::maxmsgsize, kMaxMessageBytes);
  set_ipv6(sub, endpoint);
  if (!options.curve_server_key.empty()) {
    std::array<char, 41> public_key{}, secret_key{};
    if (zmq_curve_keypair(public_key.data(), secret_key.data()) != 0)
      throw Error(ExitCode::unavailable, "libzmq was built without CURVE; install Debian's libzmq5");
    try {
      sub.set(zmq::sockopt::curve_publickey, public_key.data());
      sub.set(zmq::sockopt::curve_secretkey, secret_key.data());
      sub.set(zmq::sockopt::curve_serverkey, options.curve_server_key);
    } catch (const zmq::error_t&) {
      throw Error(ExitCode::usage, "server key '" + options.curve_server_key + "' is not 40 characters of Z85");
    }
  }
  for (const Topic topic : options.topics) sub.set(zmq::sockopt::subscribe, name_of(topic));
  try {
    sub.connect(endpoint.text);
  } catch (const zmq::error_t& error) {
    throw Error(ExitCode::configuration, endpoint.text + ": cannot connect (" + error.what() +
                                             "); write for instance ipc:///run/rapidptv/tracks.sock");
  }
}

SubscribeChannel::~SubscribeChannel() = default;

bool SubscribeChannel::receive(Topic& topic, std::span<const std::byte>& body, int timeout_ms) {
  try {
    zmq::pollitem_t item{socket_->sub.handle(), 0, ZMQ_POLLIN, 0};
    if (zmq::poll(&item, 1, std::chrono::milliseconds(timeout_ms)) == 0) return false;
    while (socket_->take(topic)) {
      if (topic != Topic::count_) {
        body = {static_cast<const std::byte*>(socket_->body.data()), socket_->body.size()};
        return true;
      }
      ++malformed_;
    }
    return false;
  } catch (const zmq::error_t& error) {
    if (error.num() == EINTR) return false;
    throw Error(ExitCode::io, std::string("receiving failed: ") + error.what());
  }
}

}  // namespace rptv
