// SPDX-License-Identifier: MIT
// The two ends of the live stream over real ZeroMQ sockets: who gets what, who loses what, and what cannot be bound.
#include "proto/channel.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <zmq.hpp>

#include "core/error.hpp"
#include "proto/endpoint.hpp"
#include "tests/proto/place.hpp"

namespace rptv {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::span<const std::byte> bytes_of(std::string_view text) { return std::as_bytes(std::span(text)); }
std::string text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

PublishOptions at(const std::string& endpoint) {
  PublishOptions options;
  options.endpoints = {endpoint};
  options.linger_ms = 0;
  return options;
}

SubscribeOptions from(const std::string& endpoint, std::vector<Topic> topics = {Topic::tracks}) {
  SubscribeOptions options;
  options.endpoint = endpoint;
  options.topics = std::move(topics);
  return options;
}

/// Publishes `text` until the subscriber has it: the connection is then complete.
void connect(PublishChannel& publisher, SubscribeChannel& subscriber, Topic topic, const std::string& text = "hello") {
  Topic got{};
  std::span<const std::byte> body;
  ASSERT_TRUE(eventually([&] {
    publisher.poll_subscriptions();
    publisher.send(topic, bytes_of(text));
    return subscriber.receive(got, body, 5) && text_of(body) == text;
  }));
}

/// Everything that arrives until `last` comes.
std::vector<std::string> receive_until(SubscribeChannel& subscriber, const std::string& last) {
  std::vector<std::string> texts;
  Topic topic{};
  std::span<const std::byte> body;
  eventually([&] {
    if (!subscriber.receive(topic, body, 5)) return false;
    texts.push_back(text_of(body));
    return texts.back() == last;
  });
  return texts;
}

/// What the constructor throws for these endpoints.
Error refusal(const PublishOptions& options) {
  try {
    const PublishChannel channel(options);
  } catch (const Error& error) {
    return error;
  }
  return {ExitCode::ok, "was not refused"};
}

TEST(Channel, carries_messages_over_ipc_and_tcp_at_once) {
  const Place place;
  PublishOptions options = at(place.ipc());
  options.endpoints.push_back("tcp://127.0.0.1:*");
  PublishChannel publisher(options);
  for (const std::string& endpoint : publisher.endpoints()) {
    SubscribeChannel subscriber(from(endpoint));
    connect(publisher, subscriber, Topic::tracks);
  }
  EXPECT_EQ(publisher.endpoints().size(), 2U);
}

TEST(Channel, knows_which_topics_somebody_wants) {
  const Place place;
  PublishChannel publisher(at(place.ipc()));
  EXPECT_FALSE(publisher.subscribed(Topic::status));
  {
    SubscribeChannel subscriber(from(place.ipc(), {Topic::status}));
    connect(publisher, subscriber, Topic::status);
    EXPECT_TRUE(publisher.subscribed(Topic::status));
    EXPECT_FALSE(publisher.subscribed(Topic::tracks));
  }
  EXPECT_TRUE(eventually([&] {
    publisher.poll_subscriptions();
    return !publisher.subscribed(Topic::status);
  }));
}

TEST(Channel, tells_of_every_late_subscriber_and_not_only_of_the_first) {
  const Place place;
  PublishChannel publisher(at(place.ipc()));
  SubscribeChannel early(from(place.ipc(), {Topic::rig}));
  connect(publisher, early, Topic::rig);
  SubscribeChannel late(from(place.ipc(), {Topic::rig, Topic::status}));
  std::uint32_t newly = 0;
  EXPECT_TRUE(eventually([&] {
    newly |= publisher.poll_subscriptions();
    return newly == (1U << static_cast<unsigned>(Topic::rig) | 1U << static_cast<unsigned>(Topic::status));
  }));
}

TEST(Channel, gives_a_subscriber_only_its_topics) {
  const Place place;
  PublishChannel publisher(at(place.ipc()));
  SubscribeChannel subscriber(from(place.ipc(), {Topic::particles}));
  connect(publisher, subscriber, Topic::particles);
  publisher.send(Topic::tracks, bytes_of("not wanted"));
  publisher.send(Topic::particles, bytes_of("wanted"));
  const auto texts = receive_until(subscriber, "wanted");
  EXPECT_EQ(std::count(texts.begin(), texts.end(), "not wanted"), 0);
  EXPECT_EQ(texts.back(), "wanted");
}

TEST(Channel, gives_two_subscribers_every_message_in_order) {
  const Place place;
  PublishChannel publisher(at(place.ipc()));
  SubscribeChannel one(from(place.ipc())), two(from(place.ipc()));
  connect(publisher, one, Topic::tracks);
  connect(publisher, two, Topic::tracks, "hello two");
  std::vector<std::string> sent;
  for (int i = 0; i < 50; ++i) {
    sent.push_back(std::to_string(i));
    EXPECT_EQ(publisher.send(Topic::tracks, bytes_of(sent.back())), Sent::sent);
  }
  for (SubscribeChannel* subscriber : {&one, &two}) {
    const auto texts = receive_until(*subscriber, "49");
    ASSERT_GE(texts.size(), 50U);
    EXPECT_EQ(std::vector(texts.end() - 50, texts.end()), sent);
  }
}

TEST(Channel, lets_a_slow_subscriber_lose_only_its_own_messages) {
  const Place place;
  PublishOptions options = at(place.ipc());
  options.high_water_mark = 4;
  PublishChannel publisher(options);
  SubscribeOptions few = from(place.ipc());
  few.high_water_mark = 1;
  SubscribeChannel slow(few), quick(from(place.ipc()));
  connect(publisher, slow, Topic::tracks);
  connect(publisher, quick, Topic::tracks, "hello quick");
  const std::string big(1 << 20, 'x');  // fills the kernel's socket buffer of the subscriber that does not read
  int queue_full = 0, received = 0;
  Topic topic{};
  std::span<const std::byte> body;
  for (int i = 0; i < 40; ++i) {
    queue_full += publisher.send(Topic::tracks, bytes_of(big)) == Sent::queue_full;
    received += eventually([&] { return quick.receive(topic, body, 5) && body.size() == big.size(); });
  }
  EXPECT_EQ(received, 40);
  EXPECT_GE(queue_full, 1);
  int left = 0;
  while (slow.receive(topic, body, 200)) left += body.size() == big.size();
  EXPECT_LT(left, 40);
}

TEST(Channel, recovers_when_the_slow_subscriber_reads_again) {
  const Place place;
  PublishOptions options = at(place.ipc());
  options.high_water_mark = 2;
  PublishChannel publisher(options);
  SubscribeOptions few = from(place.ipc());
  few.high_water_mark = 1;
  SubscribeChannel slow(few);
  connect(publisher, slow, Topic::tracks);
  const std::string big(1 << 20, 'x');
  ASSERT_TRUE(eventually([&] { return publisher.send(Topic::tracks, bytes_of(big)) == Sent::queue_full; }));
  connect(publisher, slow, Topic::tracks, "after the gap");
}

TEST(Channel, skips_and_counts_messages_of_another_form) {
  const Place place;
  zmq::context_t context;
  zmq::socket_t stranger(context, zmq::socket_type::pub);
  stranger.set(zmq::sockopt::linger, 0);
  stranger.bind(place.ipc());
  SubscribeChannel subscriber(from(place.ipc()));
  const auto send = [&](std::initializer_list<std::string_view> parts) {
    for (const auto& part : parts)
      stranger.send(zmq::buffer(part), &part + 1 == parts.end() ? zmq::send_flags::none : zmq::send_flags::sndmore);
  };
  Topic topic{};
  std::span<const std::byte> body;
  ASSERT_TRUE(eventually([&] {
    send({"tracks", "hello"});
    return subscriber.receive(topic, body, 5);
  }));
  send({"tracks"});
  send({"tracks", "one", "two"});
  send({"tracks of somebody else", "x"});
  send({"tracks", "last"});
  EXPECT_EQ(receive_until(subscriber, "last").back(), "last");
  EXPECT_EQ(subscriber.malformed(), 3U);
}

TEST(Channel, refuses_an_ipc_address_in_use_instead_of_stealing_it) {
  const Place place;
  PublishChannel first(at(place.ipc()));
  const Error error = refusal(at(place.ipc()));
  EXPECT_EQ(error.code(), ExitCode::unavailable);
  EXPECT_THAT(error.what(), AllOf(HasSubstr(place.ipc()), HasSubstr("address already in use")));
  SubscribeChannel subscriber(from(place.ipc()));
  connect(first, subscriber, Topic::tracks);
}

TEST(Channel, refuses_a_tcp_port_in_use) {
  const PublishChannel first(at("tcp://127.0.0.1:*"));
  const Error error = refusal(at(first.endpoints().front()));
  EXPECT_EQ(error.code(), ExitCode::unavailable);
  EXPECT_THAT(error.what(), AllOf(HasSubstr(first.endpoints().front()), HasSubstr("address already in use")));
}

TEST(Channel, takes_over_a_socket_that_a_killed_process_left) {
  const Place place;
  const pid_t child = fork();
  if (child == 0) {
    const PublishChannel channel(at(place.ipc()));
    _exit(0);  // as after kill -9: nobody unlinks the socket
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(std::filesystem::exists(place.file("tracks.sock")));
  PublishChannel publisher(at(place.ipc()));
  SubscribeChannel subscriber(from(place.ipc()));
  connect(publisher, subscriber, Topic::tracks);
}

TEST(Channel, never_replaces_a_file_that_is_no_socket) {
  const Place place;
  place.write("tracks.sock", "precious");
  const Error error = refusal(at(place.ipc()));
  EXPECT_EQ(error.code(), ExitCode::configuration);
  EXPECT_THAT(error.what(), HasSubstr("is no socket"));
  EXPECT_EQ(std::filesystem::file_size(place.file("tracks.sock")), 8U);
}

TEST(Channel, says_when_the_directory_is_missing) {
  const Place place;
  const Error error = refusal(at(place.ipc("missing/tracks.sock")));
  EXPECT_EQ(error.code(), ExitCode::configuration);
  EXPECT_THAT(error.what(), HasSubstr("does not exist"));
}

TEST(Channel, says_when_there_is_no_permission) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can become another user";
  const Place place;  // mode 0700
  const pid_t child = fork();
  if (child == 0) {
    if (setresuid(65534, 65534, 65534) != 0) _exit(1);
    const Error error = refusal(at(place.ipc()));
    _exit(std::strstr(error.what(), "no permission") != nullptr ? static_cast<int>(error.code()) : 2);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(WEXITSTATUS(status), static_cast<int>(ExitCode::permission));
}

TEST(Channel, refuses_tcp_beyond_loopback_without_keys) {
  for (const char* endpoint : {"tcp://*:5555", "tcp://0.0.0.0:5555", "tcp://192.168.1.2:5555", "tcp://[::]:5555"}) {
    const Error error = refusal(at(endpoint));
    EXPECT_EQ(error.code(), ExitCode::configuration) << endpoint;
    EXPECT_THAT(error.what(), AllOf(HasSubstr(endpoint), HasSubstr("curve_secret_key_file"), HasSubstr("ssh")));
  }
}

TEST(Channel, refuses_endpoints_that_are_none) {
  const std::string longer = "ipc:///tmp/" + std::string(120, 'x');
  for (const std::string& endpoint :
       {std::string("tracks"), std::string("udp://127.0.0.1:1"), std::string("ipc://"), std::string("tcp://127.0.0.1"),
        std::string("tcp://127.0.0.1:99999"), std::string("tcp://:5555"), std::string("tcp://127.0.0.1:port"), longer})
    EXPECT_EQ(refusal(at(endpoint)).code(), ExitCode::configuration) << endpoint;
}

TEST(Channel, encrypts_tcp_with_curve_and_leaves_ipc_open) {
  // The pair from ZeroMQ's own documentation of CURVE.
  const std::string public_key = "rq:rM>}U?@Lns47E1%kR.o@n%FcmmsL/@{H8]yf7";
  const std::string secret_key = "JTKVSB%%)wK0E.X)V>+}o?pNmC{O&4W4b!Ni{Lh6";
  const Place place;
  PublishOptions options = at("tcp://127.0.0.1:*");
  options.endpoints.push_back(place.ipc());
  options.curve_secret_key = secret_key;
  PublishChannel publisher(options);
  SubscribeOptions trusted = from(publisher.endpoints()[0]);
  trusted.curve_server_key = public_key;
  SubscribeChannel with_key(trusted), without_key(from(publisher.endpoints()[0])), local(from(place.ipc()));
  connect(publisher, with_key, Topic::tracks);
  connect(publisher, local, Topic::tracks, "hello local");
  Topic topic{};
  std::span<const std::byte> body;
  EXPECT_FALSE(without_key.receive(topic, body, 100));
}

TEST(CurveKey, is_read_from_a_private_file_only) {
  const Place place;
  const std::string key = "JTKVSB%%)wK0E.X)V>+}o?pNmC{O&4W4b!Ni{Lh6";
  EXPECT_EQ(read_curve_key(place.write("private", key + "\n")), key);
  const auto code_for = [](const std::filesystem::path& file) {
    try {
      read_curve_key(file);
    } catch (const Error& error) {
      return error.code();
    }
    return ExitCode::ok;
  };
  EXPECT_EQ(code_for(place.write("open", key, 0644)), ExitCode::permission);
  EXPECT_EQ(code_for(place.write("short", "abc")), ExitCode::bad_data);
  EXPECT_EQ(code_for(place.file("missing")), ExitCode::no_input);
}

TEST(Endpoint, defaults_to_the_services_directory_then_the_users_then_tmp) {
  const auto restore = [](const char* name, const char* value) {
    value != nullptr ? setenv(name, value, 1) : unsetenv(name);
  };
  const char* user = std::getenv("XDG_RUNTIME_DIR");
  const std::string saved = user != nullptr ? user : "";
  setenv("RUNTIME_DIRECTORY", "/run/rapidptv:/run/other", 1);
  setenv("XDG_RUNTIME_DIR", "/run/user/7", 1);
  EXPECT_EQ(default_endpoint(), "ipc:///run/rapidptv/tracks.sock");
  unsetenv("RUNTIME_DIRECTORY");
  EXPECT_EQ(default_endpoint(), "ipc:///run/user/7/rapidptv/tracks.sock");
  unsetenv("XDG_RUNTIME_DIR");
  EXPECT_EQ(default_endpoint(), "ipc:///tmp/rapidptv-" + std::to_string(geteuid()) + "/tracks.sock");
  restore("XDG_RUNTIME_DIR", user != nullptr ? saved.c_str() : nullptr);
}

TEST(Endpoint, lists_are_split_at_commas) {
  EXPECT_EQ(split_endpoints("ipc:///a, tcp://127.0.0.1:5 ,"),
            (std::vector<std::string>{"ipc:///a", "tcp://127.0.0.1:5"}));
  EXPECT_THROW(split_endpoints(" , "), Error);
}

}  // namespace
}  // namespace rptv
