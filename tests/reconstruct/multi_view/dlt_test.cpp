// SPDX-License-Identifier: MIT
// The DLT against a singular value decomposition.
#include "reconstruct/multi_view/dlt.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <random>
#include <vector>

#include "tests/core/instruction_sets.hpp"

namespace rptv {
namespace {

constexpr double kScale_mm = 800;  // of the columns of A: well above the points' coordinates

struct Tuple {
  Eigen::Vector3d truth_mm;
  Eigen::MatrixXd rows;
};

struct Point {
  Eigen::Vector3d at_mm;
  double s;
};

Point by_svd(const Eigen::MatrixXd& rows) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(rows, Eigen::ComputeFullV);
  const Eigen::Vector4d v = svd.matrixV().col(3);
  return {kScale_mm * v.head<3>() / v[3], svd.singularValues()[3]};
}

/// A point within 100 mm of the origin, seen by cameras at about 1 m; each row is an offset in px, wrong by `noise_px`.
Tuple make_tuple(std::mt19937& random, int views, double noise_px) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(-1, 1);
  Tuple tuple{{}, Eigen::MatrixXd(2 * views, 4)};
  for (auto& x : tuple.truth_mm) x = 100 * unit(random);
  for (int v = 0; v < views; ++v) {
    const Eigen::Vector3d camera(500 * unit(random), 500 * unit(random), -1000 + 100 * unit(random));
    const Eigen::Vector3d along = (tuple.truth_mm - camera).normalized();
    const Eigen::Vector3d across = along.cross(Eigen::Vector3d::UnitY()).normalized();
    int row = 2 * v;
    for (const Eigen::Vector3d& direction : {across, Eigen::Vector3d(along.cross(across))}) {
      const Eigen::Vector3d n = 4.4 * direction;  // px/mm
      tuple.rows.row(row++) << kScale_mm * n.transpose(), -n.dot(camera) + noise_px * normal(random);
    }
  }
  return tuple;
}

std::vector<Point> solve(const std::vector<Tuple>& tuples, InstructionSet set) {
  const Dlt dlt(set);
  const auto rows = static_cast<std::size_t>(tuples.front().rows.rows());
  std::vector<DltRow> block(rows);
  std::vector<Point> points;
  for (std::size_t first = 0; first < tuples.size(); first += kDltLanes) {
    for (std::size_t r = 0; r < rows; ++r)
      for (std::size_t k = 0; k < 4; ++k)
        for (std::size_t lane = 0; lane < kDltLanes; ++lane)
          block[r].coefficient[k][lane] =
              tuples[std::min(first + lane, tuples.size() - 1)].rows(static_cast<int>(r), static_cast<int>(k));
    DltSolutions out;
    dlt(block, out);
    for (std::size_t lane = 0; lane < kDltLanes && first + lane < tuples.size(); ++lane)
      points.push_back({kScale_mm * Eigen::Vector3d(out.x[lane], out.y[lane], out.z[lane]), out.s[lane]});
  }
  return points;
}

class DltOfViews : public ::testing::TestWithParam<int> {};

TEST_P(DltOfViews, agrees_with_the_singular_value_decomposition_to_a_nanometre_of_a_millimetre) {
  std::mt19937 random(1);
  for (const double noise_px : {0.0, 0.1, 1.0, 30.0}) {
    std::vector<Tuple> tuples;
    for (int i = 0; i < 203; ++i) tuples.push_back(make_tuple(random, GetParam(), noise_px));
    for (const auto set : testing::sets_here()) {
      const auto points = solve(tuples, set);
      for (std::size_t i = 0; i < tuples.size(); ++i) {
        const Point oracle = by_svd(tuples[i].rows);
        EXPECT_LT((points[i].at_mm - oracle.at_mm).norm(), 1e-9) << name_of(set) << ", " << noise_px << " px";
        EXPECT_NEAR(points[i].s * points[i].s, oracle.s * oracle.s, 1e-8 * (1 + oracle.s * oracle.s))
            << name_of(set) << ", " << noise_px << " px";
      }
    }
  }
}

TEST_P(DltOfViews, gives_the_same_bits_by_every_instruction_set) {
  std::mt19937 random(2);
  std::vector<Tuple> tuples;
  for (int i = 0; i < 64; ++i) tuples.push_back(make_tuple(random, GetParam(), i % 2 == 0 ? 0.1 : 500));
  const auto first = solve(tuples, InstructionSet::portable);
  for (const auto set : testing::sets_here()) {
    const auto points = solve(tuples, set);
    for (std::size_t i = 0; i < tuples.size(); ++i) {
      EXPECT_EQ(points[i].at_mm, first[i].at_mm) << name_of(set);
      EXPECT_EQ(points[i].s, first[i].s) << name_of(set);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(two_to_sixteen, DltOfViews, ::testing::Values(2, 3, 4, 16));

TEST(Dlt, finds_the_point_of_the_seeds_projection_matrices) {
  const Eigen::Vector3d truth(12, -34, 56);
  std::vector<DltRow> rows(8);
  for (std::size_t v = 0; v < 4; ++v) {
    const auto number = static_cast<double>(v);
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(0.2 * number, Eigen::Vector3d(1, number, 2).normalized()).toRotationMatrix();
    const Eigen::Vector3d shift = Eigen::Vector3d(0, 0, 1000) - turn * Eigen::Vector3d(5 * number, 0, 0);
    Eigen::Matrix<double, 3, 4> projection;
    projection << turn, shift;
    projection = Eigen::Matrix3d{{4600, 0, 960}, {0, 4600, 600}, {0, 0, 1}} * projection;
    const Eigen::Vector3d image = projection * truth.homogeneous();
    std::array<std::array<double, 4>, 3> p;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 4; ++k) p[i][k] = projection(static_cast<int>(i), static_cast<int>(k));
    const DltRowPair pair = dlt_rows(p, image[0] / image[2], image[1] / image[2]);
    for (std::size_t lane = 0; lane < kDltLanes; ++lane) put_rows(pair, lane, &rows[2 * v]);
  }
  DltSolutions out;
  Dlt()(rows, out);
  for (std::size_t lane = 0; lane < kDltLanes; ++lane) {
    EXPECT_NEAR(out.x[lane], truth[0], 1e-7);
    EXPECT_NEAR(out.y[lane], truth[1], 1e-7);
    EXPECT_NEAR(out.z[lane], truth[2], 1e-7);
  }
}

TEST(Dlt, s_is_the_root_of_the_sum_of_squared_offsets) {
  std::mt19937 random(3);
  const Tuple tuple = make_tuple(random, 4, 0.5);
  const Point point = solve({tuple}, best_instruction_set()).front();
  const Eigen::Vector4d at = (point.at_mm / kScale_mm).homogeneous();
  EXPECT_NEAR(point.s, (tuple.rows * at).norm(), 0.03 * point.s);
}

}  // namespace
}  // namespace rptv
