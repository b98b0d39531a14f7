// SPDX-License-Identifier: MIT
// The scripts, the threads that play them, and the account of what became of every frame.
#include "tests/acquisition/hostile_camera.hpp"

#include <algorithm>
#include <atomic>
#include <random>
#include <sstream>
#include <thread>

namespace rptv {

std::vector<Shot> script_of(const Faults& faults, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto happens = [&](int percent) { return static_cast<int>(random() % 100) < percent; };
  std::vector<Shot> script;
  for (std::uint64_t index = faults.first; index <= faults.last; ++index) {
    const bool away = index >= faults.leaves_at && index < faults.leaves_at + faults.away;
    if (away || happens(faults.drop)) continue;
    const Shot shot{index, happens(faults.torn), happens(faults.delay) ? static_cast<int>(random() % 40) : 0};
    script.push_back(shot);
    if (happens(faults.duplicate)) script.push_back(shot);
    if (script.size() > 1 && happens(faults.reorder)) std::swap(script.back(), script[script.size() - 2]);
  }
  return script;
}

void Expected::see(const Shot& shot) {
  ++delivered;
  const bool first = last_seen_ == 0;
  if (!first && shot.index <= last_seen_) {
    ++(shot.index == last_seen_ ? duplicates : late);
    return;
  }
  if (!first) skipped += shot.index - last_seen_ - 1;
  last_seen_ = shot.index;
  if (shot.torn)
    ++torn;
  else
    accepted.push_back(shot.index);
}

void feed(FrameSink& sink, std::uint32_t camera, const std::vector<Shot>& script, Expected& expected) {
  for (const Shot& shot : script) {
    for (int i = 0; i < shot.yields; ++i) std::this_thread::yield();
    if (send(sink, camera, shot.index, shot.torn))
      expected.see(shot);
    else
      ++expected.unclaimed;
  }
}

Found consume(Intake& intake, int dawdle) {
  Found found;
  FrameSet set;
  while ((found.end = intake.next(set, kLongNs)) == Taken::value) {
    const bool newer = found.indices.empty() || set.info().index > found.indices.back();
    if (!newer || !is_whole(set, intake.cameras())) ++found.broken_sets;
    found.indices.push_back(set.info().index);
    for (int i = 0; i < dawdle; ++i) std::this_thread::yield();
  }
  intake.close();
  return found;
}

Found run_cameras(Intake& intake, const std::vector<std::vector<Shot>>& scripts, std::vector<Expected>& expected,
                  int dawdle) {
  expected.assign(scripts.size(), {});
  std::atomic<std::size_t> running{scripts.size()};
  std::vector<std::thread> threads;
  for (std::uint32_t camera = 0; camera < scripts.size(); ++camera)
    threads.emplace_back([&, camera] {
      feed(intake, camera, scripts[camera], expected[camera]);
      if (--running == 0) intake.end();
    });
  const Found found = consume(intake, dawdle);
  for (std::thread& thread : threads) thread.join();
  return found;
}

namespace {

// Gaps: what was skipped and no failed claim explains. A failed claim may also have been for a duplicate or the end.
bool gaps_add_up(const Losses& losses, const Expected& camera) {
  const std::uint64_t gaps = losses.of(LossCause::source_gap);
  return gaps <= camera.skipped && gaps + losses.of(LossCause::pool_empty) >= camera.skipped;
}

}  // namespace

std::string account(const Intake& intake, const Found& found, const std::vector<Expected>& expected,
                    std::size_t pool_frames) {
  std::ostringstream wrong;
  if (found.end != Taken::closed) wrong << "the stream did not end; ";
  if (found.broken_sets != 0) wrong << found.broken_sets << " sets are broken or out of order; ";
  for (std::uint32_t i = 0; i < expected.size(); ++i) {
    const Losses& losses = intake.losses(i);
    const Expected& camera = expected[i];
    const auto check = [&](const char* what, std::uint64_t is, std::uint64_t should_be) {
      if (is != should_be) wrong << "camera " << i << ": " << what << ' ' << is << ", not " << should_be << "; ";
    };
    check("delivered", intake.delivered(i), camera.delivered);
    check("in sets and losses", found.indices.size() + lost_after_delivery(losses), camera.delivered);
    check("duplicates", losses.of(LossCause::source_duplicate), camera.duplicates);
    check("failed claims", losses.of(LossCause::pool_empty), camera.unclaimed);
    check("torn", losses.of(LossCause::source_torn), camera.torn);
    check("free slots", intake.free_slots(i), pool_frames);
    if (losses.of(LossCause::set_stale) < camera.late) wrong << "camera " << i << ": late frames not counted; ";
    if (!gaps_add_up(losses, camera)) wrong << "camera " << i << ": gaps do not add up; ";
    if (!std::includes(camera.accepted.begin(), camera.accepted.end(), found.indices.begin(), found.indices.end()))
      wrong << "camera " << i << ": a set that it gave no frame for; ";
  }
  return wrong.str();
}

}  // namespace rptv
