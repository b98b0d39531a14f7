// SPDX-License-Identifier: MIT
// Numbers for slots, found by looking at all of the few.
#include "acquisition/v4l2_loan.hpp"

#include <algorithm>
#include <utility>

namespace rptv {

bool V4l2Loan::claim(FrameSink& sink, std::size_t numbers) noexcept {
  numbers_ = std::min(numbers, kMostBuffers);
  std::size_t held = 0;
  for (Place& place : places_) {  // what is left of the session before moves to the front
    place.slot = SIZE_MAX;
    if (place.lease) places_[held++].lease = std::move(place.lease);
  }
  for (; held < lent_; ++held) {
    FrameLease lease = sink.claim(camera_);
    if (!lease) return false;
    places_[held].lease = std::move(lease);
  }
  for (std::size_t i = 0; i < lent_; ++i) places_[i].slot = places_[i].lease.slot();
  return true;
}

FrameLease V4l2Loan::take(std::uint32_t number) noexcept { return std::move(places_[number].lease); }

std::uint32_t V4l2Loan::put(FrameLease lease) noexcept {
  std::uint32_t number = 0;
  for (std::uint32_t i = 0; i < numbers_; ++i) {
    if (places_[i].lease) continue;
    number = i;
    if (places_[i].slot == lease.slot()) break;
  }
  places_[number].slot = lease.slot();
  places_[number].lease = std::move(lease);
  return number;
}

std::byte* V4l2Loan::memory(std::uint32_t number) const noexcept {
  return number < numbers_ && places_[number].lease ? places_[number].lease.get() : nullptr;
}

void V4l2Loan::end() noexcept {
  for (Place& place : places_) place.lease.reset();
}

}  // namespace rptv
