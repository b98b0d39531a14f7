// SPDX-License-Identifier: MIT
// The two ends of the live stream over real ZeroMQ sockets: who gets what, and who loses what.
#include "proto/channel.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <zmq.hpp>

#include "tests/proto/channels.hpp"

namespace rptv {
namespace {

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

}  // namespace
}  // namespace rptv
