// SPDX-License-Identifier: MIT
// Two lists of particles that must be equal bit for bit.
#pragma once

#include <gtest/gtest.h>

#include "core/particles.hpp"

namespace rptv::testing {

inline void expect_same(const Particles& a, const Particles& b) {
  EXPECT_EQ(a.x_mm, b.x_mm);
  EXPECT_EQ(a.y_mm, b.y_mm);
  EXPECT_EQ(a.z_mm, b.z_mm);
  EXPECT_EQ(a.residual_mm, b.residual_mm);
  EXPECT_EQ(a.support, b.support);
  EXPECT_EQ(a.ghost, b.ghost);
  EXPECT_EQ(a.covariance_mm2, b.covariance_mm2);
}

}  // namespace rptv::testing
