// SPDX-License-Identifier: MIT
// All frame sets of a recording, one after the other, without pacing.
#pragma once

#include "acquisition/intake.hpp"
#include "core/error.hpp"

namespace rptv {

/// Lets the source's frames come in through `intake`, made for its cameras and lossless, and calls use(frames) for each
/// set. Throws Error(io) when the source fails.
template <class Use>
void for_each_frame_set(Source& source, Intake& intake, const Use& use) {
  constexpr std::int64_t kPatienceNs = 100'000'000;
  source.start(intake);
  FrameSet frames;
  for (Taken taken; (taken = intake.next(frames, kPatienceNs)) != Taken::closed; frames.reset())
    if (taken != Taken::timeout) use(std::as_const(frames));
  source.stop();
  if (const std::string failure = source.failure(); !failure.empty()) throw Error(ExitCode::io, failure);
}

}  // namespace rptv
