// SPDX-License-Identifier: MIT
// The same tracks as trackpy on its own test cases; data/trackpy/README.md says where they come from.
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "core/tracks_table.hpp"
#include "tests/tracking/linking.hpp"

namespace rptv {
namespace {

const std::string kFolder = RPTV_SOURCE_DIR "/tests/tracking/data/trackpy/";

struct Case {
  std::string name;
  LinkerSettings settings;
};

std::vector<Case> read_cases() {
  CsvReader csv(kFolder + "cases.csv", {{"case"},
                                        {"range_x"},
                                        {"range_y"},
                                        {"range_z"},
                                        {"memory"},
                                        {"adaptive_stop"},
                                        {"adaptive_step"},
                                        {"velocity"}});
  std::vector<Case> cases;
  while (csv.next()) {
    Case c{std::string(csv.text(0)), settings_for(1)};
    c.settings.search_range_xyz_mm = {csv.number(1), csv.number(2), csv.number(3)};
    c.settings.memory = csv.integer(4);
    c.settings.adaptive_stop_mm = csv.number(5);
    c.settings.adaptive_step = csv.number(6);
    c.settings.max_subnet = c.settings.adaptive_stop_mm > 0 ? 15 : 0;  // trackpy's MAX_SUB_NET_SIZE_ADAPTIVE
    c.settings.predict = csv.integer(7) != 0 ? "velocity" : "none";
    cases.push_back(c);
  }
  return cases;
}

/// Identities renumbered in the order in which rows show them.
class Renumbered {
 public:
  std::uint64_t operator()(std::uint64_t id) { return number_.emplace(id, number_.size()).first->second; }
  std::size_t count() const { return number_.size(); }

 private:
  std::map<std::uint64_t, std::uint64_t> number_;
};

class Trackpy : public testing::TestWithParam<Case> {};

TEST_P(Trackpy, makes_the_same_tracks) {
  std::map<std::uint64_t, std::vector<TrackRow>> frames;
  TracksReader reader(kFolder + GetParam().name + ".csv");
  for (TrackRow row; reader.next(row);) frames[row.frame].push_back(row);
  Session session(GetParam().settings);
  Renumbered theirs, ours;
  for (const auto& [frame, rows] : frames) {
    Positions3 positions;
    for (const TrackRow& row : rows) positions.push_back({row.x_mm, row.y_mm, row.z_mm});
    const auto ids = session.next(positions, frame);
    ASSERT_EQ(ids.size(), rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i)
      ASSERT_EQ(ours(ids[i]), theirs(rows[i].particle)) << "frame " << frame << ", row " << i;
  }
  EXPECT_EQ(ours.count(), theirs.count());
  EXPECT_EQ(session.linker.counters().cut_subnets, 0U);
}

INSTANTIATE_TEST_SUITE_P(, Trackpy, testing::ValuesIn(read_cases()), [](const auto& c) { return c.param.name; });

}  // namespace
}  // namespace rptv
