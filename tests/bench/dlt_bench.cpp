// SPDX-License-Identifier: MIT
// Points and smallest singular values of four views: every instruction set beside Eigen's JacobiSVD and cv::SVD.
#include <fmt/format.h>

#include <Eigen/Dense>
#include <opencv2/core.hpp>
#include <random>
#include <vector>

#include "reconstruct/multi_view/dlt.hpp"
#include "tests/bench/contest.hpp"
#include "tests/bench/views_bench.hpp"
#include "tests/core/instruction_sets.hpp"

namespace rptv::bench {

namespace {

using Rows = Eigen::Matrix<double, 8, 4>;

constexpr std::size_t kViews = 4, kBlocks = 128, kTuples = kBlocks * kDltLanes;
constexpr int kPasses = 8;  // a run: long beside the clock's own time
constexpr double kScale_mm = 800;

struct Case {
  std::vector<Rows> matrix{kTuples};
  std::vector<DltRow> row{kBlocks * 2 * kViews};

  Case() {
    std::mt19937 random(1);
    std::normal_distribution<double> error(0, 0.1);
    std::uniform_real_distribution<double> place(-100, 100);
    for (std::size_t t = 0; t < kTuples; ++t) {
      const Eigen::Vector3d at(place(random), place(random), place(random));
      for (std::size_t v = 0; v < kViews; ++v) {
        const Eigen::Vector3d camera(v % 2 == 0 ? 400 : -400, v < 2 ? 200 : -200, -1000);
        const Eigen::Vector3d along = (at - camera).normalized();
        const Eigen::Vector3d across = along.cross(Eigen::Vector3d::UnitY()).normalized();
        const Eigen::Vector3d directions[]{across, along.cross(across)};
        for (std::size_t r = 0; r < 2; ++r) {
          const Eigen::Vector3d n = 4.4 * directions[r];
          const auto line = static_cast<int>(2 * v + r);
          matrix[t].row(line) << kScale_mm * n.transpose(), error(random) - n.dot(camera);
          for (std::size_t k = 0; k < 4; ++k)
            row[(t / kDltLanes * kViews + v) * 2 + r].coefficient[k][t % kDltLanes] =
                matrix[t](line, static_cast<int>(k));
        }
      }
    }
  }
};

Eigen::Vector3d by_jacobi(const Rows& rows, double& s) {
  const Eigen::JacobiSVD<Rows> svd(rows, Eigen::ComputeFullV);
  s = svd.singularValues()[3];
  return kScale_mm * svd.matrixV().col(3).hnormalized();
}

Eigen::Vector3d by_opencv(const Rows& rows, double& s) {
  cv::Mat a(8, 4, CV_64F), w, u, vt;
  for (int r = 0; r < 8; ++r)
    for (int k = 0; k < 4; ++k) a.at<double>(r, k) = rows(r, k);
  cv::SVD::compute(a, w, u, vt);
  s = w.at<double>(3);
  const double* v = vt.ptr<double>(3);
  return kScale_mm / v[3] * Eigen::Vector3d(v[0], v[1], v[2]);
}

double largest_difference_mm(const Case& scene, InstructionSet set) {
  double worst = 0;
  for (std::size_t b = 0; b < kBlocks; ++b) {
    DltSolutions out;
    Dlt{set}({&scene.row[b * 2 * kViews], 2 * kViews}, out);
    for (std::size_t lane = 0; lane < kDltLanes; ++lane) {
      double s = 0;
      const Eigen::Vector3d at(out.x[lane], out.y[lane], out.z[lane]);
      worst = std::max(worst, (kScale_mm * at - by_jacobi(scene.matrix[b * kDltLanes + lane], s)).norm());
    }
  }
  return worst;
}

}  // namespace

void bench_dlt(std::ostream& out, int rounds) {
  const Case scene;
  double sink = 0;
  Contest contest;
  const auto svd = [&](Eigen::Vector3d (*solve)(const Rows&, double&)) {
    for (int pass = 0; pass < kPasses; ++pass)
      for (const Rows& rows : scene.matrix) {
        double s = 0;
        sink += solve(rows, s)[0] + s;
      }
  };
  const std::size_t jacobi = contest.add("Eigen JacobiSVD 8x4", [&] { svd(by_jacobi); });
  contest.add("cv::SVD 8x4", [&] { svd(by_opencv); });
  for (const InstructionSet set : testing::sets_here())
    contest.add(std::string("rapidptv, ") + name_of(set), [&scene, &sink, set] {
      const Dlt dlt(set);
      DltSolutions found;
      for (std::size_t b = 0; b < kPasses * kBlocks; ++b) {
        dlt({&scene.row[b % kBlocks * 2 * kViews], 2 * kViews}, found);
        sink += found.x[0] + found.s[7];
      }
    });
  contest.run(rounds);
  out << fmt::format("\nDLT with s, four views, double precision ({:.0f})\n{:<28}{:>12}{:>12}\n", sink > 0 ? 1.0 : 0.0,
                     "", "ns a point", " times Jacobi");
  for (std::size_t i = 0; i < contest.size(); ++i)
    out << fmt::format("{:<28}{:>12.1f}{:>12.1f}\n", contest.name(i), contest.median_ms(i) * 1e6 / (kPasses * kTuples),
                       contest.median_ms(jacobi) / contest.median_ms(i));
  for (const InstructionSet set : testing::sets_here())
    out << fmt::format("largest difference of {} from JacobiSVD: {:.1e} mm\n", name_of(set),
                       largest_difference_mm(scene, set));
}

}  // namespace rptv::bench
