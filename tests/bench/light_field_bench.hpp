// SPDX-License-Identifier: MIT
// The tables of rptv_bench_light_field, one function each.
#pragma once

#include <iosfwd>
#include <string>

namespace rptv::bench {

struct LightFieldBenchOptions {
  int rounds = 15;   ///< alternating runs of every contender; medians are printed
  std::string dump;  ///< classification writes voxels and labels to <dump>_<number>.csv; empty: nothing
};

/// Ray counting in the seed's volumes: the plain loops, the counter that fills the volume, the one that does not.
void bench_counting(std::ostream& out, const LightFieldBenchOptions& options);

/// The threshold pass over a 2048x1536 image of which 50 000 pixels are lit.
void bench_lit_pixels(std::ostream& out, const LightFieldBenchOptions& options);

/// DBSCAN of candidate voxels beside a grid of indices and a k-d tree.
void bench_classification(std::ostream& out, const LightFieldBenchOptions& options);

/// Whole reconstruction, pixels to points with covariance, of 2048x1536 images: painted, and of the shared sets where
/// RPTV_SHARED_DATA names their folder.
void bench_frames(std::ostream& out, const LightFieldBenchOptions& options);

/// Refocusing, MART and Richardson-Lucy on the scene that ours is timed and scored on.
void bench_baselines(std::ostream& out, const LightFieldBenchOptions& options);

/// Errors of fitted particles, the Cramer-Rao bound of their scene and what their covariances promise.
void bench_accuracy(std::ostream& out, const LightFieldBenchOptions& options);

/// Recall, precision and errors against particles per lenslet, on own scenes.
void bench_density(std::ostream& out, const LightFieldBenchOptions& options);

/// Fits the ghost probability's factors, and prints predicted beside seen frequencies.
void bench_ghosts(std::ostream& out, const LightFieldBenchOptions& options);

}  // namespace rptv::bench
