// SPDX-License-Identifier: MIT
// When each image of a recording was taken: from frames.csv beside the images, else from the stated rate.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/clock.hpp"
#include "replay/image_sequence.hpp"

namespace rptv {

/// What a camera has for one instant.
struct Shot {
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::size_t image = kNone;  ///< position in the camera's ImageSequence; kNone: it has no image of this instant
  std::int64_t time_ns = 0;
};

/// All instants in which at least one camera has an image, in order of their index.
struct Timeline {
  ClockId clock = ClockId::nominal;      ///< recording: frames.csv; nominal: index / rate
  std::int64_t period_ns = 0;            ///< mean time from one index to the next
  std::vector<std::uint64_t> index;      ///< per instant, strictly rising; a jump is a frame that nobody has
  std::vector<std::vector<Shot>> shots;  ///< [camera][instant]; time_ns strictly rising
  std::uint64_t loop_indices = 0;        ///< added to the index in every further loop
  std::int64_t loop_ns = 0;              ///< added to the time in every further loop

  std::size_t instants() const noexcept { return index.size(); }
};

/// `path` is what open_cameras() was given; `rate_hz` 0: unknown; `first_index` -1: as numbered.
/// frames.csv (columns `frame`, `t` in s, optionally `file`) lies in the folder of the images, or above the folders of
/// the cameras. Rows belong to images by `file` (relative to frames.csv) if there is such a column; else by `frame` if
/// every image's number appears there; else in order, and then there must be as many. `frame` and `t` must rise.
/// Throws Error: neither rate nor frames.csv (configuration), a table that does not fit the images (bad_data).
Timeline make_timeline(const std::filesystem::path& path, const std::vector<ImageSequence>& cameras, double rate_hz,
                       std::int64_t first_index);

}  // namespace rptv
