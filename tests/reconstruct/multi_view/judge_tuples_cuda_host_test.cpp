// SPDX-License-Identifier: MIT
// The device's judgement of tuples, what it settles, and what losers keep, against the CPU's solver and plain loops.
#include "reconstruct/multi_view/judge_tuples_cuda.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "reconstruct/multi_view/tuple_solver.hpp"
#include "tests/reconstruct/multi_view/made_views.hpp"
#include "tests/reconstruct/on_device.hpp"

namespace rptv {
namespace {

using testing::OnDevice;

constexpr std::size_t kViews = 5, kDetections = 60;
constexpr double kTolerance_px = 1.5;
constexpr std::uint32_t kMinViews = 3;

using Numbers = std::array<std::uint32_t, kMaxViews>;
using Listed = std::tuple<Numbers, Point3, double, double>;

struct Judged {
  std::vector<Listed> matches;
  std::vector<Numbers> doubtful;
  void sort() { std::sort(matches.begin(), matches.end()), std::sort(doubtful.begin(), doubtful.end()); }
};

/// A scene, and tuples of its particles of which many have another's detection, or lack one.
class JudgeTuplesCuda : public ::testing::Test {
 protected:
  JudgeTuplesCuda() {
    for (const ViewRays& view : rays_) {
      seen_.emplace_back(view, kDetections, scale_mm_, false);
      seen_.back().look(scene_.detections[seen_.size() - 1]);
    }
    std::mt19937 random(3);
    for (int i = 0; i < 500; ++i) {
      ViewTuple tuple = scene_.tuples[random() % kDetections];
      for (std::size_t v = 0; v < kViews; ++v) {
        if (random() % 12 == 0) tuple.put(v, static_cast<std::uint32_t>(random() % seen_[v].size()));
        if (random() % 12 == 0) tuple.put(v, kUnseen);
      }
      if (tuple.views >= kMinViews) tuples_.push_back(tuple);
    }
  }

  Judged by_cpu() const {
    Judged judged;
    TupleSolver solver(seen_, scale_mm_, best_instruction_set());
    const auto judge = [&](const ViewMatch& found, std::size_t worst, double worst_px) {
      if (worst_px <= kTolerance_px) {
        if (std::all_of(found.at_mm.begin(), found.at_mm.end(), [](double x) { return std::abs(x) <= 100; }))
          judged.matches.emplace_back(found.tuple.detection, found.at_mm, found.square_px2, found.s);
        return;
      }
      if (found.tuple.views <= kMinViews) return;
      for (std::size_t v = 0; v < kViews; ++v) {
        if (found.tuple.detection[v] == kUnseen || (v != worst && found.tuple.views > kMinViews + 1)) continue;
        judged.doubtful.push_back(found.tuple.detection);
        judged.doubtful.back()[v] = kUnseen;
      }
    };
    for (const ViewTuple& tuple : tuples_) {
      solver.push(tuple);
      solver.solve(judge);
    }
    judged.sort();
    return judged;
  }

  /// Of detection d of view v at [v·kDetections + d].
  template <class T, class Of>
  std::vector<T> by_detection(const Of& of) const {
    std::vector<T> all(kViews * kDetections);
    for (std::size_t v = 0; v < kViews; ++v)
      for (std::size_t d = 0; d < seen_[v].size(); ++d) all[v * kDetections + d] = of(v, d);
    return all;
  }

  const testing::ViewScene scene_ = testing::make_scene(kViews, kDetections, 0.5, 0.05);
  const std::vector<ViewRays> rays_ = testing::rays_of(scene_);
  const double scale_mm_ = TupleSolver::scale_mm(scene_.volume);
  std::vector<SeenView> seen_;
  std::vector<ViewTuple> tuples_;
};

/// A list of tuples on the device.
struct List {
  List(const std::vector<ViewTuple>& tuples, std::uint32_t most)
      : capacity(most), detection(columns(tuples, most)), count({static_cast<std::uint32_t>(tuples.size())}) {}
  static std::vector<std::uint32_t> columns(const std::vector<ViewTuple>& tuples, std::size_t most) {
    std::vector<std::uint32_t> all(kViews * most);
    for (std::size_t v = 0; v < kViews; ++v)
      for (std::size_t i = 0; i < tuples.size(); ++i) all[v * most + i] = tuples[i].detection[v];
    return all;
  }
  CudaTuples view() const { return {detection.data(), count.data(), capacity, kViews}; }
  std::vector<Numbers> read(CudaStream& stream) const {
    const auto all = detection.read(stream);
    std::vector<Numbers> numbers(std::min(count.read(stream)[0], capacity), ViewTuple::none().detection);
    for (std::size_t i = 0; i < numbers.size(); ++i)
      for (std::size_t v = 0; v < kViews; ++v) numbers[i][v] = all[v * capacity + i];
    return numbers;
  }

  std::uint32_t capacity;
  OnDevice<std::uint32_t> detection, count;
};

TEST_F(JudgeTuplesCuda, is_that_of_the_cpu_with_every_schedule) {
  const Judged expected = by_cpu();
  EXPECT_GT(expected.matches.size(), 50U);
  EXPECT_GT(expected.doubtful.size(), 50U);
  const OnDevice<SeenRay> rays(by_detection<SeenRay>([&](auto v, auto d) { return seen_[v].ray(d); }));
  const OnDevice<DltRowPair> rows(by_detection<DltRowPair>([&](auto v, auto d) { return seen_[v].rows(d); }));
  std::vector<CudaViewGeometry> geometry(kViews);
  for (std::size_t v = 0; v < kViews; ++v) geometry[v].axes = rays_[v].axes();
  const OnDevice<CudaViewGeometry> geometries(geometry);
  CudaViews views{};
  views.geometry = geometries.data(), views.ray = rays.data(), views.max_detections = kDetections, views.views = kViews;
  const std::size_t most = tuples_.size();
  testing::with_every_schedule([&](unsigned threads) {
    const List tuples(tuples_, static_cast<std::uint32_t>(most)), matches({}, 1000), doubtful({}, 3000);
    const OnDevice<double> point(std::vector<double>(4 * most)), match(std::vector<double>(5000));
    double *p = point.data(), *m = match.data();
    const CudaPoints points{p, p + most, p + 2 * most, p + 3 * most};
    CudaStream stream;
    EXPECT_TRUE(solve_dlt_cuda({&rows.data()[0][0][0], kDetections}, tuples.view(), points, stream.handle(), threads) &&
                judge_tuples_cuda(views, tuples.view(), points,
                                  {scene_.volume.to - scene_.volume.centre(), scale_mm_, kTolerance_px, kMinViews},
                                  {matches.view(), m, m + 1000, m + 2000, m + 3000, m + 4000}, doubtful.view(),
                                  stream.handle(), threads));
    Judged found{{}, doubtful.read(stream)};
    const auto numbers = matches.read(stream);
    const auto value = match.read(stream);
    for (std::size_t i = 0; i < numbers.size(); ++i)
      found.matches.emplace_back(numbers[i], Point3{value[i], value[1000 + i], value[2000 + i]}, value[3000 + i],
                                 value[4000 + i]);
    found.sort();
    EXPECT_EQ(found.matches, expected.matches);
    EXPECT_EQ(found.doubtful, expected.doubtful);
  });
}

TEST_F(JudgeTuplesCuda, settles_the_detections_of_good_matches_of_all_views) {
  std::vector<double> square;
  std::vector<std::uint32_t> expected(kViews * kDetections);
  for (std::size_t i = 0; i < tuples_.size(); ++i) {
    square.push_back(static_cast<double>(i % 5));
    if (tuples_[i].views < kViews || square[i] > kViews * kTolerance_px * kTolerance_px / 4) continue;
    for (std::size_t v = 0; v < kViews; ++v) expected[v * kDetections + tuples_[i].detection[v]] = 1;
  }
  const OnDevice<double> squares(square);
  testing::with_every_schedule([&](unsigned threads) {
    const List list(tuples_, static_cast<std::uint32_t>(tuples_.size()));
    const OnDevice<std::uint32_t> settled(std::vector<std::uint32_t>(kViews * kDetections));
    CudaViews views{};
    views.settled = settled.data(), views.max_detections = kDetections, views.views = kViews;
    CudaStream stream;
    EXPECT_TRUE(settle_cuda(views, {list.view(), nullptr, nullptr, nullptr, squares.data(), nullptr}, kTolerance_px,
                            stream.handle(), threads));
    EXPECT_EQ(settled.read(stream), expected);
  });
}

TEST_F(JudgeTuplesCuda, lists_what_losers_keep) {
  std::vector<std::uint32_t> chosen, used(kViews * kDetections);
  for (std::size_t i = 0; i < tuples_.size(); ++i) chosen.push_back(i % 7 == 0 ? 1 : 0);
  for (std::size_t d = 0; d < used.size(); ++d) used[d] = d % 4 == 0 ? 1 : 0;
  std::vector<Numbers> expected;
  for (std::size_t i = 0; i < tuples_.size(); ++i) {
    ViewTuple rest = tuples_[i];
    for (std::size_t v = 0; v < kViews; ++v)
      if (rest.detection[v] != kUnseen && used[v * kDetections + rest.detection[v]] != 0) rest.put(v, kUnseen);
    if (chosen[i] == 0 && rest.views >= kMinViews && rest.views < tuples_[i].views) expected.push_back(rest.detection);
  }
  std::sort(expected.begin(), expected.end());
  EXPECT_GT(expected.size(), 50U);
  const OnDevice<std::uint32_t> chosens(chosen), useds(used);
  const List list(tuples_, static_cast<std::uint32_t>(tuples_.size()));
  testing::with_every_schedule([&](unsigned threads) {
    const List rest({}, 1000);
    CudaStream stream;
    EXPECT_TRUE(list_remains_cuda({list.view(), nullptr, nullptr, nullptr, nullptr, nullptr}, chosens.data(),
                                  useds.data(), kDetections, kMinViews, rest.view(), stream.handle(), threads));
    auto found = rest.read(stream);
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, expected);
  });
}

}  // namespace
}  // namespace rptv
