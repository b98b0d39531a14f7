// SPDX-License-Identifier: MIT
// Short ways to open both ends of a channel in a test and to know that they are connected.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "proto/channel.hpp"
#include "tests/proto/place.hpp"

namespace rptv {

inline std::span<const std::byte> bytes_of(std::string_view text) { return std::as_bytes(std::span(text)); }
inline std::string text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

inline PublishOptions at(const std::string& endpoint) {
  PublishOptions options;
  options.endpoints = {endpoint};
  options.linger_ms = 0;
  return options;
}

inline SubscribeOptions from(const std::string& endpoint, std::vector<Topic> topics = {Topic::tracks}) {
  SubscribeOptions options;
  options.endpoint = endpoint;
  options.topics = std::move(topics);
  return options;
}

/// Publishes `text` until the subscriber has it: the connection is then complete.
inline void connect(PublishChannel& publisher, SubscribeChannel& subscriber, Topic topic,
                    const std::string& text = "hello") {
  Topic got{};
  std::span<const std::byte> body;
  ASSERT_TRUE(eventually([&] {
    publisher.poll_subscriptions();
    publisher.send(topic, bytes_of(text));
    return subscriber.receive(got, body, 5) && text_of(body) == text;
  }));
}

/// Everything that arrives until `last` comes.
inline std::vector<std::string> receive_until(SubscribeChannel& subscriber, const std::string& last) {
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

}  // namespace rptv
