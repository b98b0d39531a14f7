// SPDX-License-Identifier: MIT
// Squares of several spots turned, so that the same pixel of all of them lies side by side.
#pragma once

#include <array>
#include <cstring>
#include <utility>

#include "reconstruct/detection/lanes.hpp"
#include "reconstruct/detection/spot_fit.hpp"

namespace rptv {

/// Of kLanes = 4, 8 or 16 squares. Registers are groups of four lanes: four registers that hold four pixels of spots
/// 0, 4, 8, 12, of spots 1, 5, 9, 13 and so on become, group by group, the four pixels of spots 0, 1, 2, 3, 4 … in
/// order.
template <std::size_t kLanes>
struct SquareLanes {
  using Lanes = typename LaneTypes<kLanes>::Lanes;
  using Turned = std::array<Lanes, SpotBatch::kPixels>;

  /// Pixels of the first `rows` rows, whole ones.
  RPTV_LANES static void turn(const SpotBatch::Square* squares, std::size_t rows, Turned& turned) noexcept {
    for (std::size_t k = 0; k < rows * SpotBatch::kRow; k += 4) {
      Lanes a, b, c, d;
      load(squares, k, a), load(squares + 1, k, b), load(squares + 2, k, c), load(squares + 3, k, d);
      const auto every = std::make_index_sequence<kLanes>();
      const Lanes ac_low = pick<0, kLanes, 1, kLanes + 1>(a, c, every);
      const Lanes ac_high = pick<2, kLanes + 2, 3, kLanes + 3>(a, c, every);
      const Lanes bd_low = pick<0, kLanes, 1, kLanes + 1>(b, d, every);
      const Lanes bd_high = pick<2, kLanes + 2, 3, kLanes + 3>(b, d, every);
      turned[k] = pick<0, kLanes, 1, kLanes + 1>(ac_low, bd_low, every);
      turned[k + 1] = pick<2, kLanes + 2, 3, kLanes + 3>(ac_low, bd_low, every);
      turned[k + 2] = pick<0, kLanes, 1, kLanes + 1>(ac_high, bd_high, every);
      turned[k + 3] = pick<2, kLanes + 2, 3, kLanes + 3>(ac_high, bd_high, every);
    }
  }

 private:
  // Pixels k to k + 3 of squares 0, 4, 8 …
  RPTV_LANES static void load(const SpotBatch::Square* squares, std::size_t k, Lanes& lanes) noexcept {
    if constexpr (kLanes == 4) {
      std::memcpy(&lanes, squares->data() + k, sizeof lanes);
    } else {
      typename LaneTypes<kLanes / 2>::Lanes low, high;
      SquareLanes<kLanes / 2>::load(squares, k, low), SquareLanes<kLanes / 2>::load(squares + kLanes / 2, k, high);
      lanes = join(low, high, std::make_index_sequence<kLanes>());
    }
  }
  template <class Half, std::size_t... kLane>
  RPTV_LANES static Lanes join(Half low, Half high, std::index_sequence<kLane...>) noexcept {
    return __builtin_shufflevector(low, high, kLane...);
  }
  // The same four lanes out of every group of four of two registers.
  template <std::size_t k0, std::size_t k1, std::size_t k2, std::size_t k3, std::size_t... kLane>
  RPTV_LANES static Lanes pick(Lanes a, Lanes b, std::index_sequence<kLane...>) noexcept {
    constexpr std::array<std::size_t, 4> kFrom{k0, k1, k2, k3};
    return __builtin_shufflevector(a, b, (kFrom[kLane % 4] + kLane / 4 * 4)...);
  }
  template <std::size_t>
  friend struct SquareLanes;
};

}  // namespace rptv
