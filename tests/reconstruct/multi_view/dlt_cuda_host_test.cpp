// SPDX-License-Identifier: MIT
// The device's DLT against the CPU's: the same bits for every tuple, good or bad.
#include "reconstruct/multi_view/dlt_cuda.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <random>

#include "reconstruct/multi_view/dlt.hpp"
#include "reconstruct/multi_view/view_match.hpp"
#include "tests/reconstruct/on_device.hpp"

namespace rptv {
namespace {

using testing::OnDevice;

constexpr std::uint32_t kDetections = 37;

struct Problem {
  std::vector<DltRowPair> rows;  ///< of view v's detection d: [v·kDetections + d]
  std::vector<ViewTuple> tuples;
};

/// Rows of rays that pass a point of each detection's own by `noise`: equal numbers make good tuples, others bad ones.
Problem make_problem(std::mt19937& random, std::size_t views, std::size_t tuples) {
  std::normal_distribution<double> normal;
  Problem problem;
  for (std::size_t v = 0; v < views; ++v)
    for (std::uint32_t d = 0; d < kDetections; ++d) {
      DltRowPair pair;
      for (auto& row : pair) {
        for (double& coefficient : row) coefficient = 3000 * normal(random);
        row[3] = 0.1 * normal(random);
        for (std::size_t k = 0; k < 3; ++k) row[3] -= row[k] * (0.003 * d + 0.01 * static_cast<double>(k));
      }
      problem.rows.push_back(pair);
    }
  for (std::size_t i = 0; i < tuples; ++i) {
    ViewTuple tuple = ViewTuple::none();
    const auto own = static_cast<std::uint32_t>(random() % kDetections);
    const bool bad = random() % 4 == 0;
    for (std::size_t v = 0; v < views; ++v)
      if (random() % 5 != 0) tuple.put(v, bad ? static_cast<std::uint32_t>(random() % kDetections) : own);
    problem.tuples.push_back(tuple);
  }
  return problem;
}

std::array<std::vector<double>, 4> by_cpu(const Problem& problem, std::size_t views) {
  const DltRowPair nothing{};
  std::array<std::vector<double>, 4> all;
  for (const ViewTuple& tuple : problem.tuples) {
    std::vector<DltRow> rows(2 * views);
    for (std::size_t v = 0; v < views; ++v)
      for (std::size_t lane = 0; lane < kDltLanes; ++lane)
        put_rows(tuple.detection[v] == kUnseen ? nothing : problem.rows[v * kDetections + tuple.detection[v]], lane,
                 &rows[2 * v]);
    DltSolutions found;
    Dlt(InstructionSet::portable)(rows, found);
    all[0].push_back(found.x[0]), all[1].push_back(found.y[0]), all[2].push_back(found.z[0]);
    all[3].push_back(found.s[0]);
  }
  return all;
}

std::array<std::vector<double>, 4> by_device(const Problem& problem, std::size_t views, std::uint32_t capacity,
                                             unsigned threads) {
  std::vector<std::uint32_t> detection(views * capacity);
  for (std::size_t v = 0; v < views; ++v)
    for (std::size_t i = 0; i < std::min<std::size_t>(capacity, problem.tuples.size()); ++i)
      detection[v * capacity + i] = problem.tuples[i].detection[v];
  const OnDevice<DltRowPair> rows(problem.rows);
  const OnDevice<std::uint32_t> detections(detection), count({static_cast<std::uint32_t>(problem.tuples.size())});
  const OnDevice<double> x(std::vector<double>(capacity, -7)), y(std::vector<double>(capacity, -7)),
      z(std::vector<double>(capacity, -7)), s(std::vector<double>(capacity, -7));
  CudaStream stream;
  EXPECT_TRUE(solve_dlt_cuda({&rows.data()[0][0][0], kDetections},
                             {detections.data(), count.data(), capacity, static_cast<std::uint32_t>(views)},
                             {x.data(), y.data(), z.data(), s.data()}, stream.handle(), threads));
  return {x.read(stream), y.read(stream), z.read(stream), s.read(stream)};
}

bool same(double a, double b) { return a == b || (a != a && b != b); }

class DltCuda : public ::testing::TestWithParam<std::size_t> {};

TEST_P(DltCuda, gives_the_bits_of_the_cpu_with_every_schedule) {
  std::mt19937 random(7);
  const Problem problem = make_problem(random, GetParam(), 331);
  const auto expected = by_cpu(problem, GetParam());
  std::size_t finite = 0;
  for (const double s : expected[3]) finite += std::isfinite(s) ? 1 : 0;
  EXPECT_GT(finite, GetParam() > 3 ? 300U : 100U);
  testing::with_every_schedule([&](unsigned threads) {
    const auto found = by_device(problem, GetParam(), 331, threads);
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t i = 0; i < 331; ++i)
        ASSERT_TRUE(same(found[k][i], expected[k][i])) << found[k][i] << " and " << expected[k][i];
  });
}

INSTANTIATE_TEST_SUITE_P(two_to_sixteen, DltCuda, ::testing::Values(2, 3, 4, 16));

TEST(DltCuda, leaves_alone_what_is_beyond_the_count) {
  std::mt19937 random(8);
  const Problem problem = make_problem(random, 4, 33);
  testing::with_every_schedule([&](unsigned threads) {
    const auto found = by_device(problem, 4, 100, threads);
    for (const auto& column : found)
      EXPECT_TRUE(std::all_of(column.begin() + 33, column.end(), [](double x) { return x == -7; }));
  });
}

TEST(DltCuda, solves_as_many_as_there_is_room_for_when_more_were_found) {
  std::mt19937 random(9);
  const Problem problem = make_problem(random, 4, 64);
  const auto expected = by_cpu(problem, 4), found = by_device(problem, 4, 50, 32);
  for (std::size_t i = 0; i < 50; ++i) EXPECT_TRUE(same(found[3][i], expected[3][i]));
}

TEST(DltCuda, of_no_tuples_does_nothing) {
  std::mt19937 random(10);
  for (const std::uint32_t capacity : {0U, 5U})
    EXPECT_EQ(by_device(make_problem(random, 3, 0), 3, capacity, 96)[0], std::vector<double>(capacity, -7));
}

}  // namespace
}  // namespace rptv
