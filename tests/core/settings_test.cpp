// SPDX-License-Identifier: MIT
// What settings files may say, what they are told when they say something else, and that printing them loses nothing.
#include "core/settings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "core/error.hpp"
#include "tests/core/sample_rig.hpp"

namespace rptv {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// The message and code of the Error that reading `text` throws; "no error" when it does not.
std::string complaint(std::string_view text) {
  Rig rig;
  try {
    read(rig, text);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::configuration) << text;
    EXPECT_THAT(error.what(), Not(HasSubstr("\n")));
    return error.what();
  }
  return "no error";
}

TEST(Settings, keep_their_defaults_where_the_file_is_silent) {
  Rig rig;
  read(rig, "schema = 1\nmemory = 7\n[lens]\ncentre_mm = [3, -4.5]\n");
  EXPECT_EQ(rig.memory, 7);
  EXPECT_EQ(rig.policy, "newest");
  EXPECT_EQ(rig.lens.focal_length_mm, 50);
  EXPECT_EQ(rig.lens.centre_mm, (std::vector<double>{3, -4.5}));
}

TEST(Settings, take_an_integer_for_a_number_but_not_the_other_way) {
  Rig rig;
  read(rig, "rate_hz = 25");
  EXPECT_EQ(rig.rate_hz, 25);
  EXPECT_EQ(complaint("\nmemory = 2.0"), "rig.toml:2:10: 'memory' is 2.0; it must be an integer from 0 to 100");
}

TEST(Settings, say_what_an_unknown_key_may_have_meant) {
  EXPECT_EQ(complaint("[lens]\nfocal_lenght_mm = 3.0"),
            "rig.toml:2:1: unknown key 'lens.focal_lenght_mm' (did you mean 'focal_length_mm'?)");
  EXPECT_EQ(complaint("centre_mm = [1, 2]"), "rig.toml:1:1: unknown key 'centre_mm' (did you mean 'lens.centre_mm'?)");
  EXPECT_THAT(complaint("[lns]\nfocal_length_mm = 3.0"), HasSubstr("rig.toml:1:2: unknown key 'lns'"));
  EXPECT_EQ(complaint("[lens]\ncolour = 'red'"),
            "rig.toml:2:1: unknown key 'lens.colour'; remove it, known are: focal_length_mm, centre_mm");
}

TEST(Settings, refuse_the_wrong_type_with_the_value_and_the_place) {
  EXPECT_EQ(complaint("rate_hz = 'fast'"),
            "rig.toml:1:11: 'rate_hz' is 'fast'; it must be a finite number from 0 to 1e+06");
  EXPECT_EQ(complaint("loop = 1"), "rig.toml:1:8: 'loop' is 1; it must be true or false");
  EXPECT_THAT(complaint("name = 2020-01-01"), HasSubstr("'name' is a date or time"));
  EXPECT_THAT(complaint("memory = []"), HasSubstr("'memory' is an array of 0 values"));
  EXPECT_THAT(complaint("lens = 3"), HasSubstr("rig.toml:1:8: 'lens' is 3; it must be a section [lens]"));
  EXPECT_THAT(complaint("[rate_hz]\nx = 1"), HasSubstr("'rate_hz' is a section"));
}

TEST(Settings, refuse_what_is_out_of_range_and_what_is_not_finite) {
  EXPECT_THAT(complaint("rate_hz = -1"), HasSubstr("'rate_hz' is -1; it must be a finite number from 0 to 1e+06"));
  EXPECT_THAT(complaint("memory = 101"), HasSubstr("an integer from 0 to 100"));
  for (const char* value : {"nan", "+inf", "-inf"}) {
    EXPECT_THAT(complaint(std::string("rate_hz = ") + value), HasSubstr("it must be a finite number"));
    EXPECT_THAT(complaint(std::string("weights = [1.0, ") + value + "]"), HasSubstr("finite numbers"));
  }
  EXPECT_THAT(complaint("rate_hz = 1e999"), HasSubstr("rig.toml:1:"));
}

TEST(Settings, refuse_arrays_of_the_wrong_length_and_words_that_are_no_choice) {
  EXPECT_THAT(complaint("[lens]\ncentre_mm = [1.0]"), HasSubstr("is an array of 1 values; it must be an array of 2"));
  EXPECT_THAT(complaint("[lens]\ncentre_mm = [1.0, 'a']"), HasSubstr("rig.toml:2:13"));
  EXPECT_THAT(complaint("hosts = ['a', 1]"), HasSubstr("it must be an array of strings"));
  EXPECT_EQ(complaint("policy = 'oldest'"),
            "rig.toml:1:10: 'policy' is 'oldest'; it must be one of 'newest', 'lossless'");
}

TEST(Settings, name_line_and_column_of_a_syntax_error) {
  EXPECT_THAT(complaint("memory = 1\nmemory = 2"), HasSubstr("rig.toml:2:"));
  EXPECT_THAT(complaint("name = \"open\nmemory = 1"), HasSubstr("rig.toml:1:"));
  EXPECT_THAT(complaint("memory 3"), HasSubstr("no valid TOML"));
  EXPECT_THAT(complaint("name = '\xff\xfe'"), HasSubstr("rig.toml:1:"));
}

TEST(Settings, refuse_keys_of_a_thousand_parts_without_exhausting_the_stack) {
  std::string key = "a";
  for (int i = 0; i < 200'000; ++i) key += ".a";
  EXPECT_THAT(complaint(key + " = 1"), HasSubstr("more than 32 parts"));
  EXPECT_THAT(complaint("[" + key + "]"), HasSubstr("more than 32 parts"));
  Rig rig;
  read(rig, "name = 'one. two. three.' # ....................................................................\n");
  EXPECT_EQ(rig.name, "one. two. three.");
}

TEST(Settings, refuse_a_newer_schema_and_say_to_update) {
  EXPECT_EQ(complaint("schema = 2\nfuture = 1"),
            "rig.toml:1:10: schema 2 of this configuration is newer than 1, the newest that this rapidptv reads; "
            "update rapidptv");
  EXPECT_THAT(complaint("schema = 'one'"), HasSubstr("'schema' is 'one'"));
  EXPECT_THAT(complaint("schema = 0"), HasSubstr("at least 1"));
}

TEST(Settings, require_what_is_marked_required) {
  double pitch_mm = 0;
  FieldList list;
  struct Lattice {
    double& pitch_mm;
    void fields(FieldList& l) { l.number("pitch_mm", pitch_mm, 1e-6, 10, "of the lenslets, mm").required = true; }
  } lattice{pitch_mm};
  list.section("lattice", lattice);
  const auto complaint_of = [&](std::string_view text) -> std::string {
    try {
      read_toml_text(text, "cal.toml", "calibration", 1, list);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  const std::string rest =
      "'lattice.pitch_mm' is missing (of the lenslets, mm); add it, a finite number from 1e-06 to 10";
  EXPECT_EQ(complaint_of(""), "cal.toml: " + rest);
  EXPECT_EQ(complaint_of("schema = 1\n[lattice]\n"), "cal.toml:2:1: " + rest);
  EXPECT_EQ(complaint_of("lattice.pitch_mm = 0.125"), "no error");
  EXPECT_EQ(pitch_mm, 0.125);
}

TEST(Settings, change_nothing_when_a_file_is_refused) {
  Rig rig;
  EXPECT_THROW(read(rig, "memory = 9\nrate_hz = 'x'"), Error);
  EXPECT_EQ(rig.memory, 3);
}

TEST(Settings, say_why_a_file_cannot_be_read) {
  Rig rig;
  FieldList list;
  rig.fields(list);
  const auto code_of = [&](const std::filesystem::path& file) {
    try {
      read_toml_file(file, "configuration", 1, list);
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr(file.string()));
      return error.code();
    }
    return ExitCode::ok;
  };
  const auto folder = std::filesystem::temp_directory_path() / ("rptv-settings-" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  EXPECT_EQ(code_of(folder / "absent.toml"), ExitCode::no_input);
  EXPECT_EQ(code_of(folder), ExitCode::no_input);
  std::ofstream(folder / "rig.toml") << "memory = 5\n";
  EXPECT_EQ(code_of(folder / "rig.toml"), ExitCode::ok);
  EXPECT_EQ(rig.memory, 5);
  std::filesystem::remove_all(folder);
}

TEST(Settings, refuse_characters_that_the_parser_library_cannot_take) {
  EXPECT_EQ(complaint("memory = \u00B5"),
            "rig.toml:1:10: a character beyond ASCII outside of quotes; put the text in quotes");
  EXPECT_THAT(complaint("name = \"\"\"a\\\n  \u00A7\"\"\""),
              HasSubstr("rig.toml:2:3: a character beyond ASCII behind"));
  EXPECT_THAT(complaint("name = 'a' # \xff"), HasSubstr("rig.toml:1:14: the text is not UTF-8"));
  Rig rig;
  read(rig, "# \u00B5\nname = \"\"\"\n\u00B5 \\\"\"\" \u00A7 \\\n  m\"\"\"\"\" # \u00B5\nmemory = 2\n");
  EXPECT_EQ(rig.name, "\u00B5 \"\"\" \u00A7 m\"\"");
  EXPECT_EQ(rig.memory, 2);
}

}  // namespace
}  // namespace rptv
