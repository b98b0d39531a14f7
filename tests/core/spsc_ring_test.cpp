// SPDX-License-Identifier: MIT
// SpscRing: what it promises one thread, against std::deque, and between two threads.
#include "core/spsc_ring.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <deque>
#include <thread>
#include <vector>

#include "tests/core/tracer.hpp"
#include "tests/core/workload.hpp"

namespace rptv {
namespace {

TEST(SpscRing, holds_exactly_its_capacity_also_when_that_is_no_power_of_two) {
  for (const std::size_t capacity : {1U, 2U, 3U, 5U, 8U, 100U}) {
    SpscRing<Tracer> ring(capacity);
    for (std::size_t i = 0; i < capacity; ++i) EXPECT_TRUE(ring.try_push(Tracer(i + 1)));
    EXPECT_FALSE(ring.try_push(Tracer(999)));
    EXPECT_EQ(ring.size(), capacity);
    EXPECT_EQ(ring.capacity(), capacity);
  }
}

TEST(SpscRing, of_no_capacity_holds_one) {
  SpscRing<Tracer> ring(0);
  EXPECT_TRUE(ring.try_push(Tracer(1)));
  EXPECT_FALSE(ring.try_push(Tracer(2)));
}

TEST(SpscRing, leaves_a_value_that_it_refuses_untouched) {
  SpscRing<Tracer> ring(1);
  ring.try_push(Tracer(1));
  Tracer refused(2);
  EXPECT_FALSE(ring.try_push(std::move(refused)));
  EXPECT_EQ(refused.key(), 2U);
}

TEST(SpscRing, leaves_the_receiver_untouched_when_it_is_empty) {
  SpscRing<Tracer> ring(4);
  Tracer value(7);
  EXPECT_FALSE(ring.try_pop(value));
  EXPECT_EQ(value.key(), 7U);
}

TEST(SpscRing, keeps_the_two_sides_on_different_cache_lines) {
  EXPECT_GE(alignof(SpscRing<int>), kSeparationBytes);
  EXPECT_GE(sizeof(SpscRing<int>), 3 * kSeparationBytes);  // set-up, producer, consumer, and nobody behind it
}

// Every sequence of pushes and pops does what it does to a bounded deque.
RC_GTEST_PROP(SpscRing, behaves_as_a_bounded_deque, (const std::vector<bool>& pushes)) {
  const auto capacity = *rc::gen::inRange<std::size_t>(1, 9);
  SpscRing<Tracer> ring(capacity);
  std::deque<std::uint64_t> model;
  std::uint64_t next_key = 1;
  for (const bool push : pushes) {
    if (push) {
      const bool fits = model.size() < capacity;
      RC_ASSERT(ring.try_push(Tracer(next_key)) == fits);
      if (fits) model.push_back(next_key);
      ++next_key;
    } else {
      Tracer value;
      RC_ASSERT(ring.try_pop(value) == !model.empty());
      if (model.empty()) continue;
      RC_ASSERT(value.key() == model.front());
      model.pop_front();
    }
    RC_ASSERT(ring.size() == model.size());
    RC_ASSERT(ring.pushed() - ring.popped() == model.size());
  }
}

TEST(SpscRing, keeps_order_and_content_under_contention) {
  for (const std::size_t capacity : {1U, 3U, 64U}) {
    SpscRing<Tracer> ring(capacity);
    const std::uint64_t count = rounds(capacity == 1 ? 200'000 : 2'000'000);
    std::thread producer([&] {
      for (std::uint64_t key = 1; key <= count; ++key)
        for (Tracer value(key); !ring.try_push(std::move(value));) std::this_thread::yield();
    });
    std::uint64_t wrong = 0;
    for (std::uint64_t key = 1; key <= count; ++key) {
      Tracer value;
      while (!ring.try_pop(value)) std::this_thread::yield();
      wrong += value.key() != key || value.torn() ? 1 : 0;
    }
    producer.join();
    EXPECT_EQ(wrong, 0U);
    EXPECT_EQ(ring.size(), 0U);
  }
}

TEST(SpscRing, tells_a_third_thread_a_fill_within_its_capacity) {
  SpscRing<Tracer> ring(4);
  std::atomic<bool> done{false};
  const std::uint64_t count = rounds(500'000);
  std::thread producer([&] {
    for (std::uint64_t key = 1; key <= count; ++key)
      for (Tracer value(key); !ring.try_push(std::move(value));) std::this_thread::yield();
  });
  std::thread consumer([&] {
    Tracer value;
    while (value.key() != count)
      if (!ring.try_pop(value)) std::this_thread::yield();
    done = true;
  });
  std::size_t largest = 0;
  while (!done) largest = std::max(largest, ring.size());
  producer.join();
  consumer.join();
  EXPECT_LE(largest, ring.capacity());
  EXPECT_EQ(ring.size(), 0U);
}

}  // namespace
}  // namespace rptv
