// SPDX-License-Identifier: MIT
// The value in the middle.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

namespace rptv {

/// Of an even number the upper one of the two; infinite of none.
inline double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::infinity();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace rptv
