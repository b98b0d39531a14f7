// SPDX-License-Identifier: MIT
// Mailbox: always the newest value, and every replaced one goes back to the producer.
#include "core/mailbox.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <thread>
#include <vector>

#include "tests/core/tracer.hpp"
#include "tests/core/workload.hpp"

namespace rptv {
namespace {

RC_GTEST_PROP(Mailbox, behaves_as_one_place_that_is_overwritten, (const std::vector<bool>& puts)) {
  Mailbox<Tracer> mailbox;
  std::uint64_t inside = 0;
  std::uint64_t next_key = 1;
  for (const bool put : puts) {
    Tracer value;
    if (put) {
      RC_ASSERT(mailbox.put(Tracer(next_key), value) == (inside != 0));
      RC_ASSERT(value.key() == inside);
      inside = next_key++;
    } else {
      RC_ASSERT(mailbox.take(value) == (inside != 0));
      RC_ASSERT(value.key() == inside);
      inside = 0;
    }
    RC_ASSERT(mailbox.fresh() == (inside != 0));
  }
}

TEST(Mailbox, gives_every_value_to_exactly_one_side_under_contention) {
  const std::uint64_t count = rounds(2'000'000);
  Mailbox<Tracer> mailbox;
  std::vector<std::uint8_t> seen(count + 1, 0);  // each key is written by whoever got it, so by one thread only
  std::atomic<bool> done{false};
  std::thread producer([&] {
    for (std::uint64_t key = 1; key <= count; ++key) {
      Tracer replaced;
      if (mailbox.put(Tracer(key), replaced)) ++seen[replaced.key()];
    }
    done = true;
  });
  std::uint64_t last = 0;
  std::uint64_t wrong = 0;
  const auto take_one = [&] {
    Tracer value;
    if (!mailbox.take(value)) return false;
    wrong += value.key() <= last || value.torn() ? 1 : 0;
    last = value.key();
    ++seen[last];
    return true;
  };
  while (!done)
    if (!take_one()) std::this_thread::yield();
  producer.join();
  take_one();
  EXPECT_EQ(wrong, 0U);
  EXPECT_EQ(last, count);  // the newest is never the one that is lost
  for (std::uint64_t key = 1; key <= count; ++key) ASSERT_EQ(seen[key], 1) << key;
}

}  // namespace
}  // namespace rptv
