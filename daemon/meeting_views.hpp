// SPDX-License-Identifier: MIT
// Whether the particle images of one instant meet in space as the rig says, and which cameras exchanged would do
// better.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "daemon/config.hpp"
#include "reconstruct/multi_view/multi_view.hpp"

namespace rptv {

struct Meeting {
  std::size_t expected = 0;  ///< particle images that min_views cameras have at least: so many particles there may be
  std::size_t found = 0;     ///< particles
  struct Swap {
    std::size_t one = 0, other = 0;  ///< cameras
    std::size_t found = 0;           ///< particles with their images exchanged
  };
  std::optional<Swap> swap;  ///< that makes most of less than half: at least half, and twice as many
};

/// Of the instant that `stage` has just detected. Tries all pairs of cameras with images of one size where less than
/// half of the particle images meet; not below 20, which do not tell. Main thread.
Meeting meeting_of(MultiView& stage, const Config& config, const std::vector<CameraInfo>& cameras);

/// One line with the next step; empty where there is no doubt.
std::string doubt_of(const Meeting& meeting, const Config& config, const std::vector<CameraInfo>& cameras);

}  // namespace rptv
