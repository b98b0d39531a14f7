// SPDX-License-Identifier: MIT
// Names, ranges and docs of the settings of iterative particle reconstruction.
#include "reconstruct/multi_view/iteration_settings.hpp"

namespace rptv {

void IterationSettings::fields(FieldList& list) {
  list.integer("rounds", rounds, 1, 100, "most searches of the residual images for particles that all cameras see");
  list.integer("reduced_rounds", reduced_rounds, 0, 100, "then for particles that one camera less sees");
  list.integer("sweeps", sweeps, 1, 100, "steps that all particles take after each search");
  list.integer("final_sweeps", final_sweeps, 0, 1000, "steps at the end");
  list.number("tolerance_px", tolerance_px, 0.01, 100,
              "largest reprojection error of a find, in every view; shaking makes it smaller");
  list.number("reduced_tolerance_px", reduced_tolerance_px, 0.01, 100, "the same for finds with one camera less");
  list.number("least_share", least_share, 0, 1, "light that a particle has in every view at least, of the median's");
  list.number("apart_px", apart_px, 0, 10, "of two particles that are nearer than that, the fainter goes");
  list.flag("use_tracks", use_tracks,
            "look for particles first where their tracks are expected; reconstruction and linking then take turns");
  list.number("sigma_px", sigma_px, 0, 3.4,
              "standard deviation of a particle image to start with; 0: what the first images show");
}

}  // namespace rptv
