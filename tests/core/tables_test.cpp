// SPDX-License-Identifier: MIT
// Points and tracks tables: what comes back, what is refused, and the headers that the format fixes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/error.hpp"
#include "core/tables.hpp"

namespace rptv {
namespace {

using ::testing::HasSubstr;

class Tables : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("rptv-tables-" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  static std::string content(const std::filesystem::path& file) {
    std::ostringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    return text.str();
  }
  std::filesystem::path folder_;
};

template <class Read>
std::string complaint_of_reading(Read read) {
  try {
    read();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_data);
    return error.what();
  }
  return "no error";
}

TEST_F(Tables, points_come_back_frame_by_frame) {
  const auto file = folder_ / "points.csv";
  PointsWriter writer(file, {.covariance = true, .time = true});
  writer.write({.frame = 3,
                .x_mm = 1,
                .y_mm = 2,
                .z_mm = 3,
                .residual_mm = 0.5,
                .support = 12,
                .covariance_mm2 = {1, 2, 3, 4, 5, 6},
                .t_s = 0.25});
  Particles particles(2);
  particles.push({.x_mm = 4});
  particles.push({.x_mm = 5});
  writer.write(7, 0.5, particles);
  writer.close();
  EXPECT_THAT(content(file), HasSubstr("frame,x,y,z,residual,support,var_x,var_y,var_z,cov_xy,cov_xz,cov_yz,t\n"
                                       "3,1,2,3,0.5,12,1,4,6,2,3,5,0.25\n"));
  PointsReader reader(file);
  EXPECT_TRUE(reader.has_time());
  PointFrame frame;
  ASSERT_TRUE(reader.next(frame));
  EXPECT_EQ(frame.frame, 3U);
  EXPECT_EQ(frame.t_s, 0.25);
  ASSERT_EQ(frame.points.size(), 1U);
  EXPECT_EQ(frame.points[0].support, 12);
  EXPECT_EQ(frame.points[0].covariance_mm2, (Covariance{1, 2, 3, 4, 5, 6}));
  ASSERT_TRUE(reader.next(frame));
  ASSERT_EQ(frame.points.size(), 2U);
  EXPECT_EQ(frame.points[1].x_mm, 5);
  EXPECT_FALSE(reader.next(frame));
}

TEST_F(Tables, points_have_exactly_the_header_that_the_format_fixes) {
  PointsWriter(folder_ / "p.csv").close();
  EXPECT_EQ(content(folder_ / "p.csv"), "frame,x,y,z,residual,support\n");
  TracksWriter(folder_ / "t.csv").close();
  EXPECT_EQ(content(folder_ / "t.csv"), "frame,particle,x,y,z,vx,vy,vz,residual,age,t\n");
  PointsReader reader(folder_ / "p.csv");
  PointFrame frame;
  EXPECT_FALSE(reader.next(frame));
}

TEST_F(Tables, points_out_of_order_are_refused_with_the_line) {
  const auto complaint_of_points = [](std::string_view text) {
    return complaint_of_reading([&] {
      PointsReader points = PointsReader::from_text(text, "points.csv");
      PointFrame frame;
      while (points.next(frame)) {
      }
    });
  };
  EXPECT_THAT(complaint_of_points("frame,x,y,z\n1,0,0,0\n3,0,0,0\n2,0,0,0\n"),
              HasSubstr("points.csv:4: frame 2 comes after frame 3; sort the rows by frame"));
  EXPECT_THAT(complaint_of_points("frame,x,y,z\n-1,0,0,0\n"), HasSubstr("column 'frame' is '-1', negative"));
  EXPECT_THAT(complaint_of_points("frame,x,y,z,t\n1,0,0,0,1\n1,0,0,0,2\n"), HasSubstr("points.csv:3: two times t"));
  EXPECT_THAT(complaint_of_points("frame,x,y,z,t\n1,0,0,0,1\n2,0,0,0,1\n"), HasSubstr("points.csv:3: t does not"));
  EXPECT_THAT(complaint_of_points("frame,x,z\n"), HasSubstr("no column 'y'; the header is 'frame,x,z'"));
}

TEST_F(Tables, tracks_come_back_as_they_were) {
  const auto file = folder_ / "tracks.csv";
  Tracks tracks(1);
  tracks.push({.particle = 18446744073709551U,
               .x_mm = 0.1,
               .y_mm = -0.2,
               .z_mm = 0.3,
               .vx_mm_s = 1,
               .vy_mm_s = 2,
               .vz_mm_s = 3,
               .residual_mm = 0.01,
               .age_frames = 4});
  TracksWriter writer(file);
  writer.write(9, 0.125, tracks);
  writer.close();
  TracksReader reader(file);
  TrackRow row;
  ASSERT_TRUE(reader.next(row));
  EXPECT_EQ(row.frame, 9U);
  EXPECT_EQ(row.particle, 18446744073709551U);
  EXPECT_EQ(row.x_mm, 0.1);
  EXPECT_EQ(row.vz_mm_s, 3);
  EXPECT_EQ(row.age, 4U);
  EXPECT_EQ(row.t_s, 0.125);
  EXPECT_FALSE(reader.next(row));
}

TEST_F(Tables, tracks_written_by_dataframes_are_read_too) {
  TracksReader reader = TracksReader::from_text(",y,x,z,frame,particle,mass\n0,2.0,1.0,3.0,0.0,5.0,17\n", "tp.csv");
  TrackRow row;
  ASSERT_TRUE(reader.next(row));
  EXPECT_EQ(row.particle, 5U);
  EXPECT_EQ(row.y_mm, 2);
  EXPECT_TRUE(std::isnan(row.t_s));
}

}  // namespace
}  // namespace rptv
