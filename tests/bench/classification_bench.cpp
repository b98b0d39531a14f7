// SPDX-License-Identifier: MIT
// Classification of candidate voxels: DBSCAN, eps 1.75 voxels, 6 points, over blobs of about 60 voxels.
#include <algorithm>
#include <fstream>
#include <iomanip>
#include <ostream>
#include <random>
#include <set>
#include <stdexcept>
#include <tuple>

#include "reconstruct/light_field/classify_dbscan.hpp"
#include "tests/bench/contest.hpp"
#include "tests/bench/dbscan_peers.hpp"
#include "tests/bench/light_field_bench.hpp"

namespace rptv::bench {

namespace {

constexpr double kRadius = 1.75;
constexpr std::size_t kMinPoints = 6;

VoxelCloud blobs(const VoxelGrid& grid, int count) {
  std::mt19937 random(5);
  std::uniform_int_distribution<std::int32_t> x_of(4, grid.size_x - 3), y_of(4, grid.size_y - 3),
      z_of(3, grid.planes - 4);
  std::normal_distribution<double> spread(0, 1.5);
  std::vector<CloudVoxel> voxels;
  for (int blob = 0; blob < count; ++blob) {
    const std::int32_t x = x_of(random), y = y_of(random), z = z_of(random);
    for (int i = 0; i < 75; ++i) {
      const auto near = [&](std::int32_t at, std::int32_t least, std::int32_t most) {
        return std::clamp(at + static_cast<std::int32_t>(std::lround(spread(random))), least, most);
      };
      voxels.push_back({near(x, 1, grid.size_x), near(y, 1, grid.size_y), near(z, 0, grid.planes - 1), 50});
    }
  }
  const auto order = [](const CloudVoxel& v) { return std::tuple(v.z, v.y, v.x); };
  std::sort(voxels.begin(), voxels.end(), [&](const auto& a, const auto& b) { return order(a) < order(b); });
  voxels.erase(
      std::unique(voxels.begin(), voxels.end(), [&](const auto& a, const auto& b) { return order(a) == order(b); }),
      voxels.end());
  VoxelCloud cloud(voxels.size());
  for (const auto& voxel : voxels) cloud.add(voxel);
  return cloud;
}

void dump(const std::string& file, const VoxelCloud& cloud, const std::vector<std::int32_t>& labels, double ms) {
  std::ofstream csv(file);
  csv << "# eps=" << kRadius << " min_samples=" << kMinPoints << " ms=" << ms << "\nx,y,z,label\n";
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const auto& v = cloud.voxels()[i];
    csv << v.x << ',' << v.y << ',' << v.z << ',' << labels[i] << '\n';
  }
}

void bench_one(std::ostream& out, const VoxelGrid& grid, int count, const LightFieldBenchOptions& options) {
  const VoxelCloud cloud = blobs(grid, count);
  Dbscan ours(grid, cloud.capacity(), kRadius, kMinPoints);
  IndexVolumeDbscan volume(grid);
  Labelling by_volume, by_tree;
  const std::vector<std::int32_t>* labels = nullptr;
  Contest contest;
  contest.add("ours: bit rows, runs of cores", [&] { labels = &ours.label(cloud); });
  contest.add("grid of indices, union-find on voxels", [&] { volume.run(cloud.voxels(), kMinPoints, by_volume); });
  contest.add("k-d tree (nanoflann)", [&] { kd_tree_dbscan(cloud.voxels(), kRadius, kMinPoints, by_tree); });
  contest.run(std::max(3, options.rounds / (cloud.voxels().size() > 500'000 ? 5 : 1)));
  const auto noise = static_cast<std::size_t>(std::count(labels->begin(), labels->end(), Dbscan::kNoise));
  const std::int32_t clusters = *std::max_element(labels->begin(), labels->end()) + 1;
  if (clusters != by_volume.clusters || clusters != by_tree.clusters || noise != by_volume.noise() ||
      noise != by_tree.noise())
    throw std::runtime_error("DBSCAN: the peers find other clusters");
  out << "  " << cloud.voxels().size() << " voxels: " << clusters << " clusters, " << noise << " noise\n";
  for (std::size_t i = 0; i < contest.size(); ++i)
    out << "    " << std::left << std::setw(48) << contest.name(i) << std::right << std::fixed << std::setprecision(2)
        << std::setw(10) << contest.median_ms(i) << std::setw(10)
        << contest.median_ms(i) * 1e6 / static_cast<double>(cloud.voxels().size()) << '\n';
  if (!options.dump.empty())
    dump(options.dump + "_" + std::to_string(count) + ".csv", cloud, *labels, contest.median_ms(0));
}

}  // namespace

void bench_classification(std::ostream& out, const LightFieldBenchOptions& options) {
  VoxelGrid grid;
  grid.size_x = 400, grid.size_y = 200, grid.planes = 150;
  out << "\nDBSCAN of candidate voxels, eps 1.75, 6 points, in 400x200x150; scikit-learn: "
         "tests/bench/compare_dbscan.py\n"
      << std::setw(62) << "median ms" << std::setw(10) << "ns/voxel\n";
  for (const int count : {165, 1650, 18000}) bench_one(out, grid, count, options);
}

}  // namespace rptv::bench
