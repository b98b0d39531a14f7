// SPDX-License-Identifier: MIT
// Cameras that do everything wrong, seeded; what they did; and a consumer that checks every set.
#pragma once

#include <cstdint>
#include <vector>

#include "tests/acquisition/made_frame.hpp"

namespace rptv {

/// Chances in percent per frame, and when the camera is there at all: from `first` to `last`, but for `away` frames
/// from `leaves_at` on.
struct Faults {
  int drop = 0, duplicate = 0, reorder = 0, torn = 0, delay = 0;
  std::uint64_t first = 65'400, last = 65'400 + 200;  // as a 16-bit frame counter before it wraps
  std::uint64_t leaves_at = 0, away = 0;
};

/// One frame of a camera's script. Every frame is one delivery, duplicates and late ones too.
struct Shot {
  std::uint64_t index = 0;
  bool torn = false;
  int yields = 0;  ///< how often the camera's thread gives way before it
};

std::vector<Shot> script_of(const Faults& faults, std::uint64_t seed);

/// What an intake must find in the frames that a camera in fact delivered, in their order.
struct Expected {
  std::vector<std::uint64_t> accepted;  ///< indices that the intake must take, ascending
  std::uint64_t delivered = 0, duplicates = 0, late = 0, torn = 0, skipped = 0, unclaimed = 0;
  void see(const Shot& shot);  ///< it was delivered

 private:
  std::uint64_t last_seen_ = 0;
};

/// Feeds the script in this thread.
void feed(FrameSink& sink, std::uint32_t camera, const std::vector<Shot>& script, Expected& expected);

/// What a consumer found.
struct Found {
  std::vector<std::uint64_t> indices;
  std::uint64_t broken_sets = 0;  ///< not whole, or not newer than the one before
  Taken end = Taken::timeout;     ///< what ended it: closed, unless the intake hangs
};

/// Takes sets until the stream ends or nothing comes for kLongNs; then closes. Yields up to `dawdle` times per set.
Found consume(Intake& intake, int dawdle);

/// Feeds one script per camera, each in its own thread; the last one ends the stream. Consumes in this thread.
Found run_cameras(Intake& intake, const std::vector<std::vector<Shot>>& scripts, std::vector<Expected>& expected,
                  int dawdle);

/// Empty when every frame of every camera is accounted for and every slot is home; else what is wrong.
std::string account(const Intake& intake, const Found& found, const std::vector<Expected>& expected,
                    std::size_t pool_frames);

}  // namespace rptv
