// SPDX-License-Identifier: MIT
// The publisher's thread with real subscribers: what they get, what they do not, and that nothing is held or waited
// for.
#include "daemon/publisher.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/channel.hpp"
#include "proto/encode.hpp"
#include "tests/proto/made_result.hpp"
#include "tests/proto/place.hpp"

namespace rptv {
namespace {

constexpr std::size_t kCapacity = 100;

/// A publisher on a socket of its own with the pool that its results come from.
struct Rig {
  explicit Rig(std::int64_t status_period_ms = 1000, std::int64_t queue_depth = 8) {
    settings.endpoint = place.ipc();
    settings.status_period_ms = status_period_ms;
    settings.queue_depth = queue_depth;
    publisher = std::make_unique<Publisher>(settings,
                                            PublisherContent{.particle_capacity = kCapacity,
                                                             .track_capacity = kCapacity,
                                                             .calibration_text = "pitch_um = 125",
                                                             .config_text = "schema = 1"},
                                            losses, [](StatusReport& report) {
                                              report.state = RunState::running;
                                              report.frames_in = 7;
                                            });
  }
  /// False when no result was free or the publisher did not take it.
  bool publish(std::uint64_t frame, std::size_t tracks = 3) {
    ResultLease lease = pool.claim();
    if (!lease) return false;
    fill_result(*lease, frame, tracks);
    return publisher->publish(std::move(lease));
  }
  SubscribeOptions from(std::vector<Topic> topics) const {
    SubscribeOptions options;
    options.endpoint = place.ipc();
    options.topics = std::move(topics);
    return options;
  }

  const Place place;
  PublisherSettings settings;
  Losses losses;
  ResultPool pool{16, [] { return Result(kCapacity, kCapacity); }};
  std::unique_ptr<Publisher> publisher;
};

/// The next message within `timeout_ms`, checked.
bool receive(SubscribeChannel& subscriber, WireMessage& message, int timeout_ms = 5) {
  Topic topic{};
  std::span<const std::byte> body;
  if (!subscriber.receive(topic, body, timeout_ms)) return false;
  EXPECT_EQ(decode(body, message), "");
  return true;
}

TEST(Publisher, sends_tracks_and_particles_with_every_stamp) {
  Rig rig;
  rig.publisher->start();
  SubscribeChannel subscriber(rig.from({Topic::tracks, Topic::particles}));
  WireMessage message;
  bool tracks = false, particles = false;
  std::uint64_t frame = 0;
  EXPECT_TRUE(eventually([&] {
    rig.publish(frame++);
    if (!receive(subscriber, message)) return false;
    for (const std::int64_t stamp : message.stamps.at_ns) EXPECT_GT(stamp, 0);
    EXPECT_GE(message.stamps[Stage::published], message.stamps[Stage::linked]);
    tracks |= std::holds_alternative<TracksColumns>(message.content);
    particles |= std::holds_alternative<ParticlesColumns>(message.content);
    return tracks && particles;
  }));
}

TEST(Publisher, sends_all_that_waits_before_it_stops_and_gives_every_lease_back) {
  Rig rig(1000, 8);
  rig.publisher->start();
  SubscribeChannel subscriber(rig.from({Topic::tracks}));
  WireMessage message;
  ASSERT_TRUE(eventually([&] {
    rig.publish(0);
    return receive(subscriber, message);
  }));
  ASSERT_TRUE(eventually([&] { return rig.publisher->waiting() == 0 && rig.pool.free_slots() == 16; }));
  for (std::uint64_t frame = 101; frame <= 108; ++frame) EXPECT_TRUE(rig.publish(frame));
  rig.publisher.reset();
  EXPECT_EQ(rig.pool.free_slots(), 16U);
  std::vector<std::uint64_t> frames;
  EXPECT_TRUE(eventually([&] {
    if (receive(subscriber, message) && message.frame > 100) frames.push_back(message.frame);
    return !frames.empty() && frames.back() == 108;
  }));
  EXPECT_THAT(frames, ::testing::ElementsAre(101, 102, 103, 104, 105, 106, 107, 108));
}

TEST(Publisher, counts_what_it_has_no_room_for_and_returns_the_lease) {
  Rig rig(1000, 4);  // not started: nobody takes anything
  for (std::uint64_t frame = 0; frame < 4; ++frame) EXPECT_TRUE(rig.publish(frame));
  EXPECT_FALSE(rig.publish(4));
  EXPECT_FALSE(rig.publish(5));
  EXPECT_EQ(rig.losses.of(LossCause::publish_backlog), 2U);
  EXPECT_EQ(rig.pool.free_slots(), 12U);
  rig.publisher->start();
  rig.publisher->stop();
  EXPECT_EQ(rig.publisher->frames_published(), 4U);
  EXPECT_EQ(rig.pool.free_slots(), 16U);
}

TEST(Publisher, takes_results_off_while_nobody_listens) {
  Rig rig;
  rig.publisher->start();
  std::uint64_t taken = 0;
  EXPECT_TRUE(eventually([&] {
    taken += rig.publish(taken);
    return taken == 100;
  }));
  rig.publisher->stop();
  EXPECT_EQ(rig.publisher->frames_published(), 100U);
  EXPECT_FALSE(rig.publisher->has_subscriber());
  EXPECT_EQ(rig.publisher->latency()[static_cast<std::size_t>(Stage::published)].count(), 100U);
}

TEST(Publisher, gives_a_late_subscriber_the_rig_and_the_status_at_once) {
  Rig rig(3'600'000);  // no periodic status within the test
  rig.publisher->start();
  for (int subscriber_number = 0; subscriber_number < 2; ++subscriber_number) {
    SubscribeChannel late(rig.from({Topic::rig, Topic::status}));
    WireMessage message;
    bool has_rig = false, has_status = false;
    EXPECT_TRUE(eventually([&] {
      if (!receive(late, message, 50)) return false;
      if (const auto* texts = std::get_if<RigTexts>(&message.content)) {
        EXPECT_EQ(texts->calibration, "pitch_um = 125");
        EXPECT_EQ(texts->config, "schema = 1");
        has_rig = true;
      }
      if (const auto* status = std::get_if<StatusReport>(&message.content)) {
        EXPECT_EQ(status->frames_in, 7U);
        has_status = true;
      }
      return has_rig && has_status;
    }));
  }
}

TEST(Publisher, reports_status_with_latencies_periodically) {
  Rig rig(10);
  rig.publisher->start();
  SubscribeChannel subscriber(rig.from({Topic::status}));
  WireMessage message;
  std::uint64_t frame = 0;
  EXPECT_TRUE(eventually([&] {
    rig.publish(frame++);
    if (!receive(subscriber, message)) return false;
    const auto& status = std::get<StatusReport>(message.content);
    const LatencySummary& linked = status.latency[static_cast<std::size_t>(Stage::linked)];
    return message.sequence > 3 && linked.count > 0 && linked.p50_ns >= 4'000'000 && linked.max_ns < 5'000'000;
  }));
}

TEST(Publisher, notices_a_subscriber_of_tracks) {
  Rig rig;
  rig.publisher->start();
  EXPECT_FALSE(rig.publisher->has_subscriber());
  WireMessage message;
  {
    SubscribeChannel subscriber(rig.from({Topic::tracks}));
    EXPECT_TRUE(eventually([&] { return receive(subscriber, message) || rig.publisher->has_subscriber(); }));
  }
  EXPECT_TRUE(eventually([&] { return !rig.publisher->has_subscriber(); }));
}

TEST(Publisher, keeps_the_pool_whole_with_subscribers_that_come_and_go) {
  Rig rig(10);
  rig.publisher->start();
  std::uint64_t frame = 0;
  for (int round = 0; round < 20; ++round) {
    SubscribeChannel subscriber(rig.from({Topic::tracks, Topic::particles, Topic::status}));
    WireMessage message;
    EXPECT_TRUE(eventually([&] {
      ++frame;
      rig.publish(frame, frame % kCapacity);
      return receive(subscriber, message, 1);
    }));
  }
  rig.publisher->stop();
  EXPECT_EQ(rig.pool.free_slots(), 16U);
}

}  // namespace
}  // namespace rptv
