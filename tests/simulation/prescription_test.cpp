// SPDX-License-Identifier: MIT
// Prescription files: the shipped ones read, and what is no lens is refused with line, value and next step.
#include "simulation/prescription.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.hpp"
#include "simulation/lens_analysis.hpp"

namespace rptv {
namespace {

const std::filesystem::path kShipped = std::filesystem::path(RPTV_SOURCE_DIR) / "simulation" / "prescriptions";

/// A plano-convex lens with EFL 100, one line a key; `change` replaces the line that begins with the same key.
std::string singlet(const std::string& change = "") {
  std::vector<std::string> lines{"schema = 1",
                                 "name = \"singlet\"",
                                 "source = \"test\"",
                                 "[surfaces]",
                                 "radius_mm = [50, 0]",
                                 "thickness_mm = [4, 0]",
                                 "index_after = [1.5, 1]",
                                 "clear_diameter_mm = [20, 20]",
                                 "stop = 1"};
  std::string text;
  for (const auto& line : lines) {
    const auto key = [](const std::string& row) { return row.substr(0, row.find(' ')); };
    text += (!change.empty() && key(line) == key(change) ? change : line) + "\n";
  }
  return text;
}

std::string refusal_of(const std::string& text) {
  try {
    parse_prescription(text, "lens.toml");
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::configuration);
    return error.what();
  }
  return "no error";
}

TEST(Prescription, reads_a_singlet) {
  const auto lens = parse_prescription(singlet(), "lens.toml");
  EXPECT_EQ(lens.name, "singlet");
  ASSERT_EQ(lens.surfaces.size(), 2U);
  EXPECT_EQ(lens.surfaces[0].clear_radius_mm, 10);
  EXPECT_NEAR(1 / lens_power(lens), 100, 1e-12);
}

TEST(Prescription, every_shipped_one_reads_and_names_its_source) {
  int read = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kShipped)) {
    const auto lens = read_prescription(entry.path());
    EXPECT_THAT(lens.source, testing::HasSubstr("US ")) << entry.path();
    EXPECT_TRUE(is_prescription(entry.path()));
    ++read;
  }
  EXPECT_GE(read, 2);
}

TEST(Prescription, turned_round_twice_is_itself) {
  const auto lens = read_prescription(kShipped / "double_gauss_f2.toml");
  const auto twice = lens.reversed().reversed();
  EXPECT_EQ(twice.stop, lens.stop);
  for (std::size_t i = 0; i < lens.surfaces.size(); ++i) {
    EXPECT_EQ(twice.surfaces[i].radius_mm, lens.surfaces[i].radius_mm);
    EXPECT_EQ(twice.surfaces[i].thickness_mm, lens.surfaces[i].thickness_mm);
    EXPECT_EQ(twice.surfaces[i].index_after, lens.surfaces[i].index_after);
  }
  EXPECT_NEAR(lens_power(lens.reversed()), lens_power(lens), 1e-15);  // power does not depend on the direction
}

TEST(Prescription, scaled_lens_has_the_scaled_focal_length) {
  EXPECT_NEAR(1 / lens_power(parse_prescription("scale = 0.25\n" + singlet(), "lens.toml")), 25, 1e-12);
}

struct BadLens {
  const char* change;
  const char* place;
  const char* what;
};

class RefusedPrescription : public testing::TestWithParam<BadLens> {};

TEST_P(RefusedPrescription, names_line_and_reason) {
  const std::string message = refusal_of(singlet(GetParam().change));
  EXPECT_THAT(message, testing::StartsWith(std::string("lens.toml:") + GetParam().place)) << message;
  EXPECT_THAT(message, testing::HasSubstr(GetParam().what)) << message;
}

INSTANTIATE_TEST_SUITE_P(
    Nonsense, RefusedPrescription,
    testing::Values(BadLens{"radius_mm = []", "5", "empty"}, BadLens{"radius_mm = [50, nan]", "5:", "finite numbers"},
                    BadLens{"thickness_mm = [-4, 0]", "6:", "from 0"},
                    BadLens{"index_after = [0.9, 1]", "7:", "from 1"},
                    BadLens{"thickness_mm = [4]", "6", "has 1 values but surfaces.radius_mm has 2"},
                    BadLens{"index_after = [1.5, 1.5]", "7", "must end in air"},
                    BadLens{"clear_diameter_mm = [0, 20]", "8", "the stop must have a diameter"},
                    BadLens{"clear_diameter_mm = [101, 20]", "8", "ends before its rim"},
                    BadLens{"stop = 3", "9", "there are 2 surfaces"}, BadLens{"stop = 0", "9:", "from 1"},
                    BadLens{"radius_mm = [0, 0]", "5", "no power"}));

TEST(Prescription, refuses_a_lens_that_reflects_all_its_light) {
  // A steep plano-convex rear: light beside the axis meets the last surface beyond the critical angle.
  const std::string message = refusal_of(
      "name = \"x\"\nsource = \"y\"\n[surfaces]\nradius_mm = [0, -10.5]\nthickness_mm = [1, 0]\n"
      "index_after = [4, 1]\nclear_diameter_mm = [20, 20]\nstop = 1\n");
  EXPECT_THAT(message, testing::HasSubstr("lens.toml:4: light along the axis does not get through")) << message;
}

TEST(Prescription, refuses_a_focal_length_that_the_numbers_do_not_have) {
  const std::string message = refusal_of("published_focal_length_mm = 98\n" + singlet());
  EXPECT_THAT(message,
              testing::StartsWith("lens.toml:1: published_focal_length_mm = 98 but the surfaces have 100.0000"));
  EXPECT_EQ(refusal_of("published_focal_length_mm = 100.5\n" + singlet()), "no error");
}

TEST(Prescription, refuses_a_file_that_is_not_there) {
  EXPECT_THROW(read_prescription(testing::TempDir() + "/no_such_lens.toml"), Error);
}

}  // namespace
}  // namespace rptv
