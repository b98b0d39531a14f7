// SPDX-License-Identifier: MIT
// No slot is ever in two places and none is lost: frames wander between threads by every way there is.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <memory>
#include <random>
#include <thread>
#include <vector>

#include "core/frame.hpp"
#include "core/hand_over.hpp"
#include "tests/core/workload.hpp"

namespace rptv {
namespace {

constexpr std::size_t kSlots = 70;  // more than one word of the bitmap
constexpr std::size_t kThreads = 4;

// One entry per slot: the thread that writes it, by claim; 0 when it is free. Beside the pool's own books, and plain
// where the pool says that access is exclusive, so that ThreadSanitizer sees a slot that is in two places.
struct Witness {
  std::array<std::atomic<std::uint32_t>, kSlots> writer{};
  std::atomic<std::uint64_t> wrong{0};
  std::atomic<std::uint64_t> moves{0};
};

// Each thread claims, fills, sends to the next thread by ring or mailbox, takes, shares, checks and drops.
class Wanderer {
 public:
  Wanderer(FramePool& pool, Witness& witness, HandOver<Frame>& ring_in, HandOver<Frame>& ring_out,
           HandOver<Frame>& box_in, HandOver<Frame>& box_out, std::uint32_t id)
      : pool_(pool), witness_(witness), in_{&ring_in, &box_in}, out_{&ring_out, &box_out}, random_(id), id_(id) {}

  void run(std::uint64_t steps) {
    for (std::uint64_t i = 0; i < steps; ++i) step();
    for (Frame& frame : held_) drop(frame);
    witness_.moves += moves_;
  }

 private:
  void step() {
    Frame& mine = held_[random_() % held_.size()];
    switch (random_() % 4) {
      case 0:
        claim(mine);
        break;
      case 1:
        send(mine, *out_[random_() % 2]);
        break;
      case 2:
        receive(mine, *in_[random_() % 2]);
        break;
      default:
        share(mine, held_[random_() % held_.size()]);
        break;
    }
  }
  void claim(Frame& frame) {
    drop(frame);
    frame.lease = pool_.claim();
    if (!frame.lease) return;
    ++moves_;
    // The slot was free: nobody may be writing it, and now only we do.
    if (witness_.writer[frame.lease.slot()].exchange(id_, std::memory_order_relaxed) != 0) ++witness_.wrong;
    frame.info.index = random_();
    *reinterpret_cast<std::uint64_t*>(frame.lease.get()) = frame.info.index;
    if (witness_.writer[frame.lease.slot()].exchange(0, std::memory_order_relaxed) != id_) ++witness_.wrong;
  }
  void check(const Frame& frame) {
    if (!frame.lease) return;
    if (*reinterpret_cast<const std::uint64_t*>(frame.lease.get()) != frame.info.index) ++witness_.wrong;
  }
  void send(Frame& frame, HandOver<Frame>& out) {
    if (!frame.lease) return;
    check(frame);
    out.push(std::move(frame));
    drop(frame);  // Bounded and full: still ours
    ++moves_;
  }
  void receive(Frame& frame, HandOver<Frame>& in) {
    drop(frame);
    if (in.pop(frame, 0) == Taken::value) ++moves_;
    check(frame);
  }
  void share(const Frame& from, Frame& to) {
    if (&from == &to || !from.lease) return;
    drop(to);
    to.info = from.info;
    to.lease = from.lease.share();
    ++moves_;
  }
  void drop(Frame& frame) {
    check(frame);
    frame.lease.reset();
  }

  FramePool& pool_;
  Witness& witness_;
  std::array<HandOver<Frame>*, 2> in_;
  std::array<HandOver<Frame>*, 2> out_;
  std::array<Frame, 12> held_;
  std::minstd_rand random_;
  std::uint32_t id_;
  std::uint64_t moves_ = 0;
};

TEST(Ownership, no_slot_is_ever_in_two_places_and_none_is_lost) {
  FramePool pool(kSlots, sizeof(std::uint64_t));
  Witness witness;
  Losses losses;
  {
    std::vector<std::unique_ptr<HandOver<Frame>>> rings;
    std::vector<std::unique_ptr<HandOver<Frame>>> boxes;
    for (std::size_t i = 0; i < kThreads; ++i) {
      rings.push_back(std::make_unique<HandOver<Frame>>(Bounded{5}, losses));
      boxes.push_back(std::make_unique<HandOver<Frame>>(Newest{}, losses));
    }
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < kThreads; ++i)
      threads.emplace_back([&, i, next = (i + 1) % kThreads] {
        Wanderer(pool, witness, *rings[i], *rings[next], *boxes[i], *boxes[next], static_cast<std::uint32_t>(i + 1))
            .run(rounds(6'000'000));
      });
    for (std::thread& thread : threads) thread.join();
  }
  EXPECT_EQ(witness.wrong, 0U);
  EXPECT_GE(witness.moves, rounds(10'000'000));
  EXPECT_EQ(pool.free_slots(), kSlots);
}

}  // namespace
}  // namespace rptv
