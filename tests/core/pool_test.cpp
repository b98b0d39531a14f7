// SPDX-License-Identifier: MIT
// Slots, leases and the two pools: who holds what, and that it comes back.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <thread>
#include <vector>

#include "core/error.hpp"
#include "core/frame.hpp"
#include "core/frame_pool.hpp"
#include "core/object_pool.hpp"
#include "core/spsc_ring.hpp"

namespace rptv {
namespace {

TEST(FramePool, hands_out_every_slot_once_and_then_none) {
  for (const std::size_t slots : {1U, 63U, 64U, 65U, 130U}) {
    FramePool pool(slots, 100);
    std::vector<FrameLease> leases;
    std::vector<bool> seen(slots, false);
    for (std::size_t i = 0; i < slots; ++i) {
      leases.push_back(pool.claim());
      ASSERT_TRUE(leases.back());
      ASSERT_FALSE(seen[leases.back().slot()]);
      seen[leases.back().slot()] = true;
    }
    EXPECT_FALSE(pool.claim());
    EXPECT_EQ(pool.free_slots(), 0U);
    leases.clear();
    EXPECT_EQ(pool.free_slots(), slots);
  }
}

TEST(FramePool, aligns_slots_to_pages_and_keeps_them_apart) {
  FramePool pool(3, 5000);
  const FrameLease a = pool.claim();
  const FrameLease b = pool.claim();
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(a.get()) % FramePool::kAlignmentBytes, 0U);
  EXPECT_GE(std::abs(b.get() - a.get()), 5000);
}

TEST(FramePool, refuses_what_cannot_be_with_an_error_that_names_the_setting) {
  const auto code_of = [](std::size_t slots, std::size_t bytes) {
    try {
      FramePool pool(slots, bytes);
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("pool_frames"), std::string::npos) << error.what();
      return error.code();
    }
    return ExitCode::ok;
  };
  EXPECT_EQ(code_of(0, 100), ExitCode::configuration);
  EXPECT_EQ(code_of(4, 0), ExitCode::configuration);
  EXPECT_EQ(code_of(1024, std::size_t{1} << 40), ExitCode::unavailable);
  EXPECT_EQ(code_of(2, SIZE_MAX), ExitCode::unavailable);
  EXPECT_EQ(code_of(2, SIZE_MAX / 2 + 1), ExitCode::unavailable);
}

TEST(FramePool, wakes_who_waits_for_a_slot) {
  FramePool pool(1, 8);
  FrameLease only = pool.claim();
  const std::uint32_t seen = pool.prepare_to_wait();
  std::thread other([lease = std::move(only)]() mutable { lease.reset(); });
  pool.wait_for_slot(seen, 20'000'000'000);
  EXPECT_TRUE(pool.claim());
  other.join();
}

TEST(Lease, is_empty_after_it_was_moved_from) {
  FramePool pool(2, 8);
  FrameLease first = pool.claim();
  FrameLease second = std::move(first);
  EXPECT_FALSE(first);
  EXPECT_TRUE(second);
  EXPECT_EQ(pool.free_slots(), 1U);
}

TEST(Lease, returns_its_slot_when_another_is_moved_into_it) {
  FramePool pool(2, 8);
  FrameLease first = pool.claim();
  first = pool.claim();
  EXPECT_EQ(pool.free_slots(), 1U);
  FrameLease& same = first;
  first = std::move(same);
  EXPECT_TRUE(first);
  EXPECT_EQ(pool.free_slots(), 1U);
}

TEST(Lease, keeps_a_shared_slot_out_until_the_last_is_dropped) {
  FramePool pool(1, 8);
  FrameLease first = pool.claim();
  FrameLease second = first.share();
  EXPECT_EQ(first.get(), second.get());
  first.reset();
  EXPECT_EQ(pool.free_slots(), 0U);
  second.reset();
  EXPECT_EQ(pool.free_slots(), 1U);
  EXPECT_FALSE(second.share());
}

TEST(Lease, is_not_kept_by_the_ring_cell_that_it_passed_through) {
  FramePool pool(2, 8);
  SpscRing<Frame> ring(4);
  ring.try_push(Frame{{}, {}, pool.claim()});
  {
    Frame taken;
    ASSERT_TRUE(ring.try_pop(taken));
    EXPECT_EQ(pool.free_slots(), 1U);
  }
  EXPECT_EQ(pool.free_slots(), 2U);
}

TEST(ObjectPool, reuses_its_objects_with_what_their_last_user_left) {
  ObjectPool<int> pool(2, [] { return 7; });
  auto first = pool.claim();
  auto second = pool.claim();
  EXPECT_FALSE(pool.claim());
  *first = 11;
  first.reset();
  EXPECT_EQ(pool.free_slots(), 1U);
  EXPECT_EQ(*pool.claim(), 11);
  EXPECT_EQ(*second, 7);
}

// Any sequence of claims, shares and drops agrees with plain counting.
RC_GTEST_PROP(SlotBook, agrees_with_plain_counting, (const std::vector<std::uint8_t>& steps)) {
  const auto slots = *rc::gen::inRange<std::size_t>(1, 100);
  SlotBook book(slots);
  std::vector<std::size_t> held;  // one entry per lease
  const auto out = [&](std::size_t slot) { return std::count(held.begin(), held.end(), slot); };
  std::size_t busy = 0;
  for (const std::uint8_t step : steps) {
    if (step % 3 == 0 || held.empty()) {
      const std::size_t slot = book.claim();
      RC_ASSERT((slot == SlotBook::kNone) == (busy == slots));
      if (slot == SlotBook::kNone) continue;
      RC_ASSERT(out(slot) == 0);
      held.push_back(slot);
      ++busy;
    } else if (step % 3 == 1) {
      held.push_back(held[step % held.size()]);
      book.share(held.back());
    } else {
      const std::size_t slot = held[step % held.size()];
      held.erase(held.begin() + step % static_cast<std::ptrdiff_t>(held.size()));
      const bool last = out(slot) == 0;
      RC_ASSERT(book.drop(slot) == last);
      busy -= last ? 1 : 0;
    }
    RC_ASSERT(book.free_slots() == slots - busy);
  }
}

}  // namespace
}  // namespace rptv
