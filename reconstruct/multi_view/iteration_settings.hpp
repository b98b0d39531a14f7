// SPDX-License-Identifier: MIT
// What a user can choose about iterative particle reconstruction; all of it fixed when the stage is built.
#pragma once

#include "core/settings.hpp"

namespace rptv {

/// Wieneke, Meas. Sci. Technol. 24 (2013) 024008; Jahn, Schanz & Schröder, Exp. Fluids 62 (2021) 179.
struct IterationSettings {
  std::int64_t rounds = 6;            ///< most searches of the residual images for particles that all cameras see
  std::int64_t reduced_rounds = 4;    ///< then for particles that one camera less finds
  std::int64_t sweeps = 4;            ///< steps of all particles after each search
  std::int64_t final_sweeps = 8;      ///< and at the end
  double tolerance_px = 0.8;          ///< largest reprojection error of a find, in every view: overlaps shift maxima
  double reduced_tolerance_px = 0.5;  ///< the same for finds with one camera less
  double least_share = 0.3;           ///< a particle has at least this share of the median light, in every view
  double apart_px = 0.7;              ///< of two particles that are nearer, the fainter goes
  bool use_tracks = true;             ///< look first where tracks are expected (`rapidptv run`)
  double sigma_px = 0;                ///< of a particle image, to start with; 0: from the first images

  void fields(FieldList& list);
};

}  // namespace rptv
