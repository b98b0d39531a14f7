// SPDX-License-Identifier: MIT
// What a user can say about a replay.
#pragma once

#include <cstdint>
#include <string>

#include "core/settings.hpp"

namespace rptv {

/// Faults that a replay adds. Chosen by (seed, instant since the start, camera) alone: the same in every run.
struct ReplayFaults {
  std::int64_t seed = 1;
  double drop_fraction = 0;
  double duplicate_fraction = 0;
  double torn_fraction = 0;
  double reorder_fraction = 0;
  double bunch_fraction = 0;
  double clock_jump_fraction = 0;
  std::int64_t clock_jump_ns = 1'000'000;

  void fields(FieldList& list) {
    list.integer("seed", seed, 0, INT64_MAX, "seed of the faults: equal seeds give equal faults");
    list.number("drop_fraction", drop_fraction, 0, 1, "frames never delivered (never the first or last instant)");
    list.number("duplicate_fraction", duplicate_fraction, 0, 1, "frames delivered twice");
    list.number("torn_fraction", torn_fraction, 0, 1, "frames whose lower part is missing, marked as torn");
    list.number("reorder_fraction", reorder_fraction, 0, 0.5,
                "instants in which one camera delivers after the other cameras' next frame");
    list.number("bunch_fraction", bunch_fraction, 0, 1,
                "frames held back to arrive together with the next, at most 4 in a bunch");
    list.number("clock_jump_fraction", clock_jump_fraction, 0, 1, "frames from which on the camera's clock is shifted");
    list.integer("clock_jump_ns", clock_jump_ns, -1'000'000'000'000, 1'000'000'000'000, "size of one shift, ns");
  }
};

struct ReplaySettings {
  std::string path;
  std::string pattern;
  double rate_hz = 0;
  double speed = 1;
  std::int64_t loop = 1;
  std::int64_t first_index = -1;
  std::int64_t significant_bits = 0;
  bool preload = false;
  std::int64_t preload_limit_mb = 4096;
  ReplayFaults faults;

  void fields(FieldList& list) {
    list.text("path", path, "folder of PNG or TIFF images (or of folders cam0, cam1, ...), or a multi-page TIFF");
    list.text("pattern", pattern,
              "glob for the names of frames; empty: frame_* if any, else cam<number>_*, else all but dark*, white*, "
              "background*");
    list.number("rate_hz", rate_hz, 0, 1e6, "frame rate of the recording, Hz; frames.csv goes first; 0: unknown");
    list.number("speed", speed, 0, 1e6, "1: real time, 2: twice as fast, 0: as fast as possible");
    list.integer("loop", loop, 0, 1'000'000'000, "how often the recording is played; 0: for ever");
    list.integer("first_index", first_index, -1, 1'000'000'000'000'000,
                 "index of the first frame; -1: the number in its name or in frames.csv");
    list.integer("significant_bits", significant_bits, 0, 16,
                 "grey values lie below 2^bits, for instance 12 in 16-bit files; 0: what the files say");
    list.flag("preload", preload, "decode all images into memory before the start");
    list.integer("preload_limit_mb", preload_limit_mb, 1, 1'000'000, "most memory that preload may take, MB (10^6)");
    list.section("faults", faults);
  }
};

}  // namespace rptv
