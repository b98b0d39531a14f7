// SPDX-License-Identifier: MIT
// What diffraction at a square lenslet makes of a pixel's light, as a short symmetric filter.
#pragma once

#include <vector>

namespace rptv {

/// Weights k[0] … k[R] of a filter along one axis, k[|i|] for a pixel i away: light sinc²(x/b) about its point with
/// b = λ·f/pitch (first dark line), gathered by a pixel. R is where the rest has less than 2.5 % a side, at most
/// `longest`; the weights that are left sum to less than 1. No diffraction (`first_zero_um` 0): {1}. Set-up only.
std::vector<float> diffraction_filter(double first_zero_um, double pixel_um, std::size_t longest);

}  // namespace rptv
