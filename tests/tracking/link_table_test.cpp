// SPDX-License-Identifier: MIT
// Tables of points become tables of tracks: times, rates, trackpy's columns, errors.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "core/error.hpp"
#include "tests/tracking/linking.hpp"
#include "tracking/link_table.hpp"

namespace rptv {
namespace {

/// A file of its own, gone with the object.
struct TemporaryFile {
  TemporaryFile() { close(mkstemp(path)); }
  ~TemporaryFile() { std::filesystem::remove(path); }
  char path[32] = "/tmp/rptv_tracks_XXXXXX";
};

std::vector<TrackRow> link(const std::string& table, const LinkerSettings& settings, double rate_hz = 100) {
  const TemporaryFile file;
  PointsReader points = PointsReader::from_text(table, "points.csv");
  TracksWriter writer(file.path);
  link_table(points, "points.csv", settings, {.rate_hz = rate_hz}, writer);
  writer.close();
  std::vector<TrackRow> rows;
  TracksReader reader(file.path);
  for (TrackRow row; reader.next(row);) rows.push_back(row);
  return rows;
}

TEST(LinkTable, takes_times_from_the_table) {
  const auto rows = link("frame,x,y,z,residual,support,t\n4,0,0,0,0.01,9,1.0\n5,0.1,0,0,0.02,9,1.5\n", settings_for(1));
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[1].particle, rows[0].particle);
  EXPECT_EQ(rows[1].frame, 5U);
  EXPECT_EQ(rows[1].age, 1U);
  EXPECT_EQ(rows[1].t_s, 1.5);
  EXPECT_NEAR(rows[1].vx_mm_s, 0.2, 1e-12);
  EXPECT_EQ(rows[1].residual_mm, 0.02);
}

TEST(LinkTable, takes_times_from_the_rate_where_the_table_has_none) {
  const auto rows = link("frame,x,y,z\n0,0,0,0\n2,0.1,0,0\n", settings_for(1, 1), 50);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_NEAR(rows[1].t_s, 0.04, 1e-15);
  EXPECT_NEAR(rows[1].vx_mm_s, 2.5, 1e-9);
}

TEST(LinkTable, reads_a_table_of_trackpy_in_the_plane) {
  const auto rows = link(
      ",y,x,mass,size,ecc,signal,raw_mass,ep,frame\n"
      "0,5.5,1.0,300,2,0.1,20,900,0.05,0\n1,9.5,8.0,300,2,0.1,20,900,0.05,0\n"
      "0,9.4,8.2,300,2,0.1,20,900,0.05,1\n1,5.6,1.1,300,2,0.1,20,900,0.05,1\n",
      settings_for(1));
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_EQ(rows[2].particle, rows[1].particle);
  EXPECT_EQ(rows[3].particle, rows[0].particle);
  EXPECT_EQ(rows[2].z_mm, 0);
}

TEST(LinkTable, grows_with_its_frames_and_links_the_same) {
  std::string table = "frame,x,y,z\n";
  for (int frame = 0; frame < 12; ++frame)
    for (int i = 0; i < 10 + 30 * frame; ++i)
      table += std::to_string(frame) + "," + std::to_string(3 * i) + "," + std::to_string(0.1 * frame) + ",0\n";
  LinkerSettings settings = settings_for(1, 2, "kalman");
  const auto rows = link(table, settings);
  Session session(settings);
  std::size_t row = 0;
  for (int frame = 0; frame < 12; ++frame) {
    Positions3 positions;
    for (int i = 0; i < 10 + 30 * frame; ++i) positions.push_back({3.0 * i, std::stod(std::to_string(0.1 * frame)), 0});
    for (const std::uint64_t id : session.next(positions)) EXPECT_EQ(rows.at(row++).particle, id);
  }
  EXPECT_EQ(row, rows.size());
}

TEST(LinkTable, smooths_with_a_lag_and_keeps_every_row) {
  const TemporaryFile file;
  PointsReader points = PointsReader::from_text("frame,x,y\n0,0,0\n1,0.12,0\n2,0.18,0\n3,0.3,0\n", "points.csv");
  TracksWriter writer(file.path, {.estimate = true});
  link_table(points, "points.csv", settings_for(1, 0, "kalman"), {.rate_hz = 1, .smooth_frames = 2}, writer);
  writer.close();
  CsvReader csv(file.path, {{"frame"}, {"particle"}, {"vx"}, {"var_x"}, {"cov_xz"}, {"var_vx"}, {"ax"}});
  std::uint64_t frames = 0;
  for (; csv.next(); ++frames) {
    EXPECT_EQ(csv.index(0), frames);
    EXPECT_EQ(csv.index(1), 0U);
    EXPECT_NEAR(csv.number(2), 0.1, 0.1);
    EXPECT_GT(csv.number(3), 0);
    EXPECT_GT(csv.number(5), 0);
  }
  EXPECT_EQ(frames, 4U);
}

TEST(LinkTable, names_the_frame_that_is_too_large) {
  LinkerSettings settings = settings_for(1);
  settings.max_particles = 2;
  try {
    link("frame,x,y,z\n0,0,0,0\n7,1,0,0\n7,2,0,0\n7,3,0,0\n", settings);
    FAIL() << "three points fit two places";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::bad_data);
    EXPECT_THAT(e.what(), testing::StartsWith("points.csv: frame 7 has 3 points; give --max-particles 3"));
  }
}

TEST(LinkTable, refuses_a_time_that_no_clock_shows) {
  EXPECT_THROW(link("frame,x,y,z,t\n0,0,0,0,1e10\n", settings_for(1)), Error);
}

}  // namespace
}  // namespace rptv
