// SPDX-License-Identifier: MIT
// Points and matrices of image and object space.
#pragma once

#include <array>

namespace rptv {

using Point3 = std::array<double, 3>;                  ///< x, y, z, mm
using Matrix3 = std::array<std::array<double, 3>, 3>;  ///< row, column

}  // namespace rptv
