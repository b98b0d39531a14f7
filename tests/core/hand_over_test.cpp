// SPDX-License-Identifier: MIT
// HandOver: each policy against a model, and closing in the middle of everything.
#include "core/hand_over.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <deque>
#include <thread>
#include <vector>

#include "tests/core/tracer.hpp"
#include "tests/core/workload.hpp"

namespace rptv {
namespace {

constexpr std::int64_t kLongNs = 20'000'000'000;  // a bound for what must come

HandOverPolicy any_policy() {
  const auto depth = *rc::gen::inRange<std::size_t>(0, 5);
  return *rc::gen::element<HandOverPolicy>(Newest{}, Bounded{depth}, Lossless{depth});
}

// What a hand-over must do, said with a deque.
struct Model {
  HandOverPolicy policy;
  std::deque<std::uint64_t> waiting;
  std::uint64_t superseded = 0, over_bound = 0, after_close = 0;
  bool closed = false;

  bool would_wait() const {
    return !closed && std::holds_alternative<Lossless>(policy) && waiting.size() == depth_of(policy);
  }
  bool push(std::uint64_t key) {
    if (closed) return ++after_close, false;
    if (waiting.size() < depth_of(policy)) return waiting.push_back(key), true;
    if (std::holds_alternative<Bounded>(policy)) return ++over_bound, false;
    waiting.front() = key;
    return ++superseded, false;
  }
};

RC_GTEST_PROP(HandOver, behaves_as_its_model_under_every_policy, ()) {
  Model model{any_policy(), {}, 0, 0, 0, false};
  Losses losses;
  HandOver<Tracer> queue(model.policy, losses);
  const auto steps = *rc::gen::container<std::vector<int>>(rc::gen::inRange(0, 41));  // 0: close, odd: push, even: pop
  std::uint64_t next_key = 1;
  for (const int step : steps) {
    if (step == 0) {
      queue.close();
      model.closed = true;
    } else if (step % 2 == 1) {
      if (model.would_wait()) continue;
      RC_ASSERT(queue.push(Tracer(next_key)) == model.push(next_key));
      ++next_key;
    } else {
      Tracer value;
      const Taken empty = model.closed ? Taken::closed : Taken::timeout;
      RC_ASSERT(queue.pop(value, 0) == (model.waiting.empty() ? empty : Taken::value));
      if (model.waiting.empty()) continue;
      RC_ASSERT(value.key() == model.waiting.front());
      model.waiting.pop_front();
    }
    RC_ASSERT(queue.waiting() == model.waiting.size());
  }
  RC_ASSERT(losses.of(LossCause::superseded) == model.superseded);
  RC_ASSERT(losses.of(LossCause::over_bound) == model.over_bound);
  RC_ASSERT(losses.of(LossCause::after_close) == model.after_close);
  RC_ASSERT(losses.total() == model.superseded + model.over_bound + model.after_close);
}

TEST(HandOver, counts_a_full_queue_by_the_cause_it_was_given) {
  Losses losses;
  HandOver<Tracer> queue(Bounded{1}, losses, LossCause::writer_backlog);
  EXPECT_TRUE(queue.push(Tracer(1)));
  EXPECT_FALSE(queue.push(Tracer(2)));
  EXPECT_EQ(losses.of(LossCause::writer_backlog), 1U);
}

TEST(HandOver, loses_nothing_when_lossless_and_the_consumer_dawdles) {
  Losses losses;
  HandOver<Tracer> queue(Lossless{2}, losses);
  const std::uint64_t count = rounds(300'000);
  std::thread producer([&] {
    for (std::uint64_t key = 1; key <= count; ++key) queue.push(Tracer(key));
    queue.close();
  });
  std::uint64_t expected = 1;
  Tracer value;
  Taken taken;
  while ((taken = queue.pop(value, kLongNs)) == Taken::value) {
    ASSERT_EQ(value.key(), expected++);
    if (expected % 64 == 0) std::this_thread::yield();
  }
  producer.join();
  EXPECT_EQ(taken, Taken::closed);
  EXPECT_EQ(expected, count + 1);
  EXPECT_EQ(losses.total(), 0U);
}

TEST(HandOver, frees_a_producer_that_waits_for_room_when_it_is_closed) {
  Losses losses;
  HandOver<Tracer> queue(Lossless{1}, losses);
  queue.push(Tracer(1));
  std::thread producer([&] { EXPECT_FALSE(queue.push(Tracer(2))); });
  queue.close();
  producer.join();
  EXPECT_EQ(losses.of(LossCause::after_close), 1U);
  Tracer value;
  EXPECT_EQ(queue.pop(value, 0), Taken::value);
  EXPECT_EQ(value.key(), 1U);
  EXPECT_EQ(queue.pop(value, 0), Taken::closed);
}

TEST(HandOver, wakes_a_consumer_that_sleeps_when_it_is_closed) {
  Losses losses;
  HandOver<Tracer> queue(Newest{}, losses);
  std::thread consumer([&] {
    Tracer value;
    EXPECT_EQ(queue.pop(value, kLongNs), Taken::closed);
  });
  queue.close();
  consumer.join();
}

// Closes from a third thread at a random moment: each value is taken or counted, none slips in behind `closed`.
void close_in_the_middle(const HandOverPolicy& policy, std::uint64_t moment) {
  Losses losses;
  HandOver<Tracer> queue(policy, losses);
  std::atomic<std::uint64_t> pushed{0};
  std::atomic<bool> stop{false};
  std::thread producer([&] {
    while (!stop) {
      queue.push(Tracer(pushed + 1));
      if (++pushed % 16 == 0) std::this_thread::yield();  // else it holds a core against those who end the round
    }
  });
  std::thread closer([&] {
    while (pushed < moment) std::this_thread::yield();
    queue.close();
  });
  std::uint64_t taken = 0;
  Tracer value;
  while (queue.pop(value, kLongNs) == Taken::value) ++taken;
  stop = true;
  producer.join();
  closer.join();
  EXPECT_EQ(queue.waiting(), 0U);
  EXPECT_EQ(taken + losses.total(), pushed.load());
  EXPECT_LE(moment, pushed.load());
}

TEST(HandOver, accounts_for_every_value_when_closed_in_the_middle_of_pushes) {
  for (std::uint64_t i = 0; i < rounds(2'000); ++i) {
    close_in_the_middle(Newest{}, i % 50);
    close_in_the_middle(Lossless{1 + i % 3}, i % 50);
    close_in_the_middle(Bounded{1 + i % 3}, i % 50);
  }
}

}  // namespace
}  // namespace rptv
