// SPDX-License-Identifier: MIT
// Bundler: against a model that thinks in instants instead of queues, and against the intersection of all cameras.
#include "acquisition/bundler.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <vector>

#include "tests/acquisition/made_frame.hpp"

namespace rptv {
namespace {

using Indices = std::vector<std::uint64_t>;

// A bundler with what it needs around it.
struct Bundling {
  Bundling(std::size_t cameras, std::size_t room, std::size_t patience) : pool(cameras * (room + 1), 16) {
    std::vector<Losses*> pointers;
    for (std::size_t i = 0; i < cameras; ++i) {
      losses.push_back(std::make_unique<Losses>());
      pointers.push_back(losses.back().get());
    }
    bundler = std::make_unique<Bundler>(std::move(pointers), BundlerOptions{.room = room, .patience = patience});
  }
  void offer(std::size_t camera, std::uint64_t index) {
    bundler->offer(made_frame(pool.claim(), static_cast<std::uint32_t>(camera), index), 0);
  }
  // Every set that can be had now; RC_ASSERTs that each is whole.
  void take_all(Indices& into) {
    for (FrameSet set; bundler->take(set, 0);) {
      RC_ASSERT(is_whole(set, losses.size()));
      into.push_back(set.info().index);
    }
  }
  FramePool pool;
  std::vector<std::unique_ptr<Losses>> losses;
  std::unique_ptr<Bundler> bundler;
};

// What a bundler must do, said with instants: which cameras have shown a frame of each index that is still open.
struct Model {
  std::size_t cameras, patience;
  std::map<std::uint64_t, std::set<std::size_t>> open;
  std::uint64_t horizon = 0;
  Indices sets;
  std::map<std::size_t, std::uint64_t> incomplete, stale;

  std::size_t held(std::size_t camera) const {
    return static_cast<std::size_t>(
        std::count_if(open.begin(), open.end(), [&](const auto& one) { return one.second.contains(camera); }));
  }
  void close_oldest(bool published) {
    const auto [index, shown] = *open.begin();
    horizon = index + 1;
    if (published) sets.push_back(index);
    if (!published)
      for (const std::size_t camera : shown) ++incomplete[camera];
    open.erase(open.begin());
  }
  // A missing camera that has shown anything later will never show this one; one that has shown nothing is waited for.
  bool is_hopeless(const std::set<std::size_t>& shown) const {
    bool out_of_patience = false;
    for (std::size_t camera = 0; camera < cameras; ++camera) {
      if (!shown.contains(camera) && held(camera) > 0) return true;
      if (held(camera) > 0 && held(camera) - 1 > patience) out_of_patience = true;
    }
    return out_of_patience;
  }
  void settle() {
    while (!open.empty()) {
      const auto& shown = open.begin()->second;
      const bool complete = shown.size() == cameras;
      if (!complete && !is_hopeless(shown)) return;
      close_oldest(complete);
    }
  }
  void offer(std::size_t camera, std::uint64_t index) {
    if (index < horizon) {
      ++stale[camera];
    } else {
      open[index].insert(camera);
    }
    settle();
  }
};

RC_GTEST_PROP(Bundler, behaves_as_a_model_that_thinks_in_instants, ()) {
  const auto cameras = *rc::gen::inRange<std::size_t>(2, 5);
  const auto patience = *rc::gen::inRange<std::size_t>(0, 5);
  const bool forever = *rc::gen::arbitrary<bool>();
  const auto steps = *rc::gen::container<std::vector<std::pair<std::size_t, std::uint64_t>>>(
      rc::gen::pair(rc::gen::inRange<std::size_t>(0, cameras), rc::gen::inRange<std::uint64_t>(0, 4)));
  Model model{cameras, forever ? BundlerOptions::kForever : patience, {}, 0, {}, {}, {}};
  Bundling real(cameras, patience + 2, model.patience);
  Indices sets;
  Indices next(cameras, 0);
  for (const auto& [camera, skip] : steps) {
    RC_ASSERT(real.bundler->lacks(camera) == (model.held(camera) == 0));
    RC_ASSERT(real.bundler->has_room(camera) == (model.held(camera) < patience + 2));
    RC_ASSERT(forever || real.bundler->has_room(camera));
    while (!real.bundler->has_room(camera)) {
      RC_ASSERT(real.bundler->give_up_oldest());
      model.close_oldest(false);
      real.take_all(sets);
      model.settle();
    }
    next[camera] += skip + 1;
    real.offer(camera, next[camera]);
    real.take_all(sets);
    model.offer(camera, next[camera]);
    RC_ASSERT(sets == model.sets);
  }
  for (std::size_t camera = 0; camera < cameras; ++camera) {
    const Losses& losses = *real.losses[camera];
    RC_ASSERT(losses.of(LossCause::set_incomplete) == model.incomplete[camera]);
    RC_ASSERT(losses.of(LossCause::set_stale) == model.stale[camera]);
    RC_ASSERT(losses.total() == model.incomplete[camera] + model.stale[camera]);
  }
  while (real.bundler->give_up_oldest()) real.take_all(sets);
  RC_ASSERT(real.pool.free_slots() == real.pool.slots());
}

// However the cameras interleave: with patience enough, a frame is in a set exactly when every camera has one of its
// index.
RC_GTEST_PROP(Bundler, publishes_exactly_what_all_cameras_saw, ()) {
  const auto cameras = *rc::gen::inRange<std::size_t>(2, 5);
  const auto indices = *rc::gen::container<std::vector<Indices>>(
      cameras, rc::gen::map(rc::gen::container<Indices>(rc::gen::inRange<std::uint64_t>(0, 60)), [](Indices some) {
        std::sort(some.begin(), some.end());
        some.erase(std::unique(some.begin(), some.end()), some.end());
        return some;
      }));
  Indices common = indices[0];
  for (const Indices& one : indices) {
    Indices both;
    std::set_intersection(common.begin(), common.end(), one.begin(), one.end(), std::back_inserter(both));
    common = both;
  }
  Bundling real(cameras, 64, BundlerOptions::kForever);
  Indices sets;
  Indices offered(cameras, 0);
  for (const std::size_t turn :
       *rc::gen::container<std::vector<std::size_t>>(400, rc::gen::inRange<std::size_t>(0, cameras))) {
    if (offered[turn] == indices[turn].size()) continue;
    real.offer(turn, indices[turn][offered[turn]++]);
    real.take_all(sets);
  }
  for (std::size_t camera = 0; camera < cameras; ++camera)
    for (; offered[camera] < indices[camera].size(); real.take_all(sets))
      real.offer(camera, indices[camera][offered[camera]++]);
  while (real.bundler->give_up_oldest()) real.take_all(sets);
  RC_ASSERT(sets == common);
  for (std::size_t camera = 0; camera < cameras; ++camera)
    RC_ASSERT(real.losses[camera]->total() == indices[camera].size() - common.size());
}

TEST(Bundler, gives_a_set_up_at_once_when_its_partner_has_passed_it) {
  Bundling real(2, 4, BundlerOptions::kForever);
  Indices sets;
  real.offer(0, 7);
  real.offer(0, 8);
  real.offer(1, 8);  // camera 1 lost 7
  real.take_all(sets);
  EXPECT_EQ(sets, Indices{8});
  EXPECT_EQ(real.losses[0]->of(LossCause::set_incomplete), 1U);
  EXPECT_EQ(real.losses[1]->total(), 0U);
}

TEST(Bundler, waits_for_a_late_camera_as_long_as_it_was_told_and_no_longer) {
  Bundling real(2, 4, 2);
  Indices sets;
  for (const std::uint64_t index : {1U, 2U, 3U}) real.offer(0, index);
  real.take_all(sets);
  EXPECT_EQ(real.losses[0]->total(), 0U) << "two newer frames are within its patience";
  real.offer(0, 4);
  real.take_all(sets);
  EXPECT_EQ(real.losses[0]->of(LossCause::set_incomplete), 1U) << "three are not";
  real.offer(1, 1);
  EXPECT_EQ(real.losses[1]->of(LossCause::set_stale), 1U);
  real.offer(1, 2);
  real.take_all(sets);
  EXPECT_EQ(sets, Indices{2});
}

TEST(Bundler, has_nothing_to_give_up_when_it_is_empty) {
  Bundling real(3, 2, 0);
  EXPECT_FALSE(real.bundler->give_up_oldest());
  FrameSet set;
  EXPECT_FALSE(real.bundler->take(set, 0));
}

}  // namespace
}  // namespace rptv
