// SPDX-License-Identifier: MIT
// What a camera that is killed now and then sent in each of its lives, held against what came of it.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "tests/acquisition/gvsp_truth.hpp"

namespace rptv {

/// Image numbers are life · 2³² + 1, + 2, …
class CameraLives {
 public:
  /// An image came, in the order of their numbers.
  void came(std::uint64_t number) {
    Seen& seen = seen_[number >> 32];
    const std::uint64_t image = number & 0xffffffffU;
    if (seen.first == 0) seen.first = image;
    seen.newest = image;
  }
  /// A life is over, its last image sent.
  void over(std::uint64_t life, const GvspTruth& truth) { lives_.push_back({life, truth.sent, truth.begun}); }

  /// All that was sent; the image under way at a kill may have left or not.
  std::uint64_t least() const { return sum(&Life::sent); }
  std::uint64_t most() const { return sum(&Life::begun); }
  /// Of what was sent next to an outage nobody can know, if it does not come: after the newest image that came before
  /// it and before the first one after it. It is in the estimate. Everything else must have come or be counted.
  std::uint64_t next_to_outages() const {
    std::uint64_t all = 0;
    for (std::size_t i = 0; i < lives_.size(); ++i) {
      const auto found = seen_.find(lives_[i].number);
      const Seen seen = found == seen_.end() ? Seen{} : found->second;
      if (i > 0 && seen.first > 0) all += seen.first - 1;
      if (i + 1 < lives_.size() && lives_[i].sent > seen.newest) all += lives_[i].sent - seen.newest;
    }
    return all;
  }
  /// `accounted`: what came or was counted; `estimated`: for the outages, each rounded to a frame.
  bool explain(std::uint64_t accounted, std::uint64_t estimated) const {
    return accounted <= most() && accounted + next_to_outages() >= least() &&
           next_to_outages() <= estimated + lives_.size();
  }

 private:
  struct Life {
    std::uint64_t number = 0, sent = 0, begun = 0;
  };
  struct Seen {
    std::uint64_t first = 0, newest = 0;
  };
  std::uint64_t sum(std::uint64_t Life::*what) const {
    std::uint64_t all = 0;
    for (const Life& life : lives_) all += life.*what;
    return all;
  }
  std::map<std::uint64_t, Seen> seen_;
  std::vector<Life> lives_;
};

}  // namespace rptv
