// SPDX-License-Identifier: MIT
// Boards and points from files, and what is refused in them; triangulation with what they tell.
#include "calibration/cameras/board.hpp"

#include <gmock/gmock.h>

#include "calibration/cameras/board_image.hpp"
#include "calibration/cameras/rig_accuracy.hpp"
#include "tests/calibration/cameras/board_rig.hpp"
#include "tests/proto/place.hpp"

namespace rptv {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

struct BoardFile : ::testing::Test {
  std::string refusal(const std::string& text) {
    const auto file = place.write("board.toml", "schema = 1\n" + text);
    return refusal_of([&] { read_board(file); });
  }
  Place place;
};

TEST_F(BoardFile, of_charuco_gives_inner_corners_row_by_row) {
  const auto file = place.write(
      "board.toml", "schema = 1\nkind = \"charuco\"\ncolumns = 4\nrows = 3\nsquare_mm = 20\nmarker_mm = 15\n");
  const auto points = read_board(file).points();
  ASSERT_EQ(points.size(), 6U);
  EXPECT_EQ(points[0], (Point3{20, 20, 0}));
  EXPECT_EQ(points[4], (Point3{40, 40, 0}));
}

TEST_F(BoardFile, names_what_cannot_be_built) {
  EXPECT_THAT(refusal("kind = \"charuco\"\ncolumns = 7\nrows = 2\nsquare_mm = 20\nmarker_mm = 15\n"),
              HasSubstr("rows = 2"));
  EXPECT_THAT(refusal("kind = \"charuco\"\ncolumns = 7\nrows = 9\nsquare_mm = 20\nmarker_mm = 25\n"),
              HasSubstr("marker_mm = 25"));
  EXPECT_THAT(refusal("kind = \"charuco\"\ncolumns = 20\nrows = 20\nsquare_mm = 20\nmarker_mm = 15\n"),
              HasSubstr("200 markers and DICT_5X5_100 has 100"));
  EXPECT_THAT(refusal("kind = \"dots\"\ncolumns = 7\nrows = 7\nsquare_mm = 20\n"), HasSubstr("right angle"));
  EXPECT_THAT(refusal("kind = \"dots\"\ncolumns = 7\nrows = 8\n"), HasSubstr("square_mm"));
  EXPECT_THAT(refusal("kind = \"points\"\n"), HasSubstr("points_file"));
  EXPECT_THAT(refusal("kind = \"points\"\npoints_file = \"nowhere.txt\"\n"), HasSubstr("nowhere.txt"));
}

TEST_F(BoardFile, of_known_points_reads_them_and_what_was_seen_of_them) {
  place.write(
      "cube.txt",
      "# id x y z\n10 0 0 0\n11, 10, 0, 0\n12 0 10 0\n13\t0 0 10\n\n14 5 5 5 # middle\n15 1 2 3\n16 2 3 1\n17 9 9 9\n");
  const Board board =
      read_board(place.write("board.toml", "schema = 1\nkind = \"points\"\npoints_file = \"cube.txt\"\n"));
  ASSERT_EQ(board.points().size(), 8U);
  EXPECT_EQ(board.points()[3], (Point3{0, 0, 10}));
  const auto seen = read_seen_points(place.write("seen.txt", "14 100.5 200.25\n11 1 2\n"), board);
  ASSERT_EQ(seen.size(), 2U);
  EXPECT_EQ(seen[0].point, 1U);
  EXPECT_EQ(seen[1].pixel, (Pixel{100.5, 200.25}));
  const auto refusal_in = [&](const char* text) {
    const auto file = place.write("seen.txt", text);
    return refusal_of([&] { read_seen_points(file, board); });
  };
  EXPECT_THAT(refusal_in("14 1 2\n99 1 2\n"), HasSubstr("id 99"));
  EXPECT_THAT(refusal_in("14 1 2\n14 1 3\n"), AllOf(HasSubstr("seen.txt:2"), HasSubstr("twice")));
  EXPECT_THAT(refusal_in("14 1 2\n15 one 3\n"), HasSubstr("seen.txt:2"));
  EXPECT_THAT(refusal_in("# nothing\n"), HasSubstr("no points"));
}

TEST(RigAccuracy, triangulates_and_expects_the_errors_that_noise_makes) {
  const BoardRig rig(small_board().points(), 1);
  const auto models = models_of(rig.truth);
  const Point3 truth{12, -30, 25};
  std::mt19937 random(9);
  std::normal_distribution<double> noise(0, 0.1);
  constexpr int kTries = 400;
  Point3 squares{};
  for (int n = 0; n < kTries; ++n) {
    std::vector<Sighting> sightings;
    for (const auto& model : models) {
      const Pixel at = *model.project(truth);
      sightings.push_back({&model, {at[0] + noise(random), at[1] + noise(random)}});
    }
    const auto found = triangulate(sightings);
    ASSERT_TRUE(found);
    for (std::size_t axis = 0; axis < 3; ++axis) squares[axis] += std::pow((*found)[axis] - truth[axis], 2) / kTries;
  }
  const auto expected = expected_error_mm(models, truth, 0.1);
  ASSERT_TRUE(expected);
  for (std::size_t axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(std::sqrt(squares[axis]) / (*expected)[axis], 1, 0.15) << axis;
  EXPECT_FALSE(triangulate(std::vector<Sighting>{{&models[0], {600, 500}}}));
}

}  // namespace
}  // namespace rptv
