// SPDX-License-Identifier: MIT
// What settings files may say, what they are told when they say something else, and that printing them loses nothing.
#include "core/settings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>

#include "core/error.hpp"

namespace rptv {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

struct Lens {
  double focal_length_mm = 50;
  std::vector<double> centre_mm = {1, 2};
  void fields(FieldList& list) {
    list.number("focal_length_mm", focal_length_mm, 1e-3, 1e4, "of the main lens, mm");
    list.numbers("centre_mm", centre_mm, 2, -100, 100, "where the axis meets the array, mm");
  }
};

struct Rig {
  std::string name = "rig";
  std::string policy = "newest";
  std::int64_t memory = 3;
  bool loop = false;
  double rate_hz = 100;
  std::vector<double> weights;
  Lens lens;
  void fields(FieldList& list) {
    list.text("name", name, "of the rig");
    list.choice("policy", policy, {"newest", "lossless"}, "what to do when behind");
    list.integer("memory", memory, 0, 100, "frames that a particle may be unseen");
    list.flag("loop", loop, "begin again at the end");
    list.number("rate_hz", rate_hz, 0, 1e6, "frames per second");
    list.numbers("weights", weights, 0, -1e300, 1e300, "any number of them");
    list.section("lens", lens);
  }
};

void read(Rig& rig, std::string_view text) {
  FieldList list;
  rig.fields(list);
  read_toml_text(text, "rig.toml", "configuration", 1, list);
}

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

std::string set_complaint(std::string_view assignment) {
  Rig rig;
  FieldList list;
  rig.fields(list);
  try {
    set_field(list, assignment);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::usage);
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

TEST(Settings, are_set_one_by_one_from_a_command_line) {
  Rig rig;
  FieldList list;
  rig.fields(list);
  for (const char* assignment : {"memory=12", "rate_hz=1e3", "loop=true", "name=a=b c", "policy=lossless",
                                 "weights=1, 2.5,-3", "lens.centre_mm=[4,5]"})
    set_field(list, assignment);
  EXPECT_EQ(rig.memory, 12);
  EXPECT_EQ(rig.rate_hz, 1000);
  EXPECT_TRUE(rig.loop);
  EXPECT_EQ(rig.name, "a=b c");
  EXPECT_EQ(rig.policy, "lossless");
  EXPECT_EQ(rig.weights, (std::vector<double>{1, 2.5, -3}));
  EXPECT_EQ(rig.lens.centre_mm, (std::vector<double>{4, 5}));
  set_field(list, "weights=");
  EXPECT_TRUE(rig.weights.empty());
}

TEST(Settings, refuse_a_bad_assignment_from_a_command_line) {
  EXPECT_THAT(set_complaint("memory"), HasSubstr("has no '='"));
  EXPECT_THAT(set_complaint("memroy=1"), HasSubstr("did you mean 'memory'"));
  EXPECT_EQ(set_complaint("memory=1.5"), "--set 'memory=1.5': 'memory' must be an integer from 0 to 100");
  EXPECT_THAT(set_complaint("rate_hz=nan"), HasSubstr("finite number"));
  EXPECT_THAT(set_complaint("rate_hz=1x"), HasSubstr("finite number"));
  EXPECT_THAT(set_complaint("loop=yes"), HasSubstr("true or false"));
  EXPECT_THAT(set_complaint("lens.centre_mm=1"), HasSubstr("array of 2"));
  EXPECT_THAT(set_complaint("name=\xff"), HasSubstr("UTF-8"));
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

/// Any finite double, every exponent as likely as any other.
double any_double(std::mt19937_64& random, double largest) {
  while (true) {
    const auto value = std::bit_cast<double>(random());
    if (std::isfinite(value) && std::fabs(value) <= largest) return value;
  }
}

std::string any_text(std::mt19937_64& random) {
  const char* pieces[] = {"a", "\"", "\\", "\n", "\t", "\x01", "\x7f", "µ", "粒", "🫧", "'", "#", "=", " ", "\r"};
  std::string text;
  for (auto left = random() % 20; left > 0; --left) text += pieces[random() % std::size(pieces)];
  return text;
}

TEST(Settings, come_back_bit_for_bit_from_their_own_text) {
  std::mt19937_64 random(2024);
  for (int round = 0; round < 2000; ++round) {
    Rig rig, again;
    rig.name = any_text(random);
    rig.policy = random() % 2 != 0 ? "newest" : "lossless";
    rig.memory = static_cast<std::int64_t>(random() % 101);
    rig.loop = random() % 2 != 0;
    rig.rate_hz = std::fabs(any_double(random, 1e6));
    rig.lens.centre_mm = {any_double(random, 100), round == 0 ? -0.0 : any_double(random, 100)};
    for (auto left = random() % 5; left > 0; --left) rig.weights.push_back(any_double(random, 1e300));
    FieldList list;
    rig.fields(list);
    read(again, to_toml(list, 1));
    ASSERT_EQ(again.name, rig.name);
    ASSERT_EQ(again.policy, rig.policy);
    ASSERT_EQ(again.memory, rig.memory);
    ASSERT_EQ(again.loop, rig.loop);
    ASSERT_EQ(std::bit_cast<std::uint64_t>(again.rate_hz), std::bit_cast<std::uint64_t>(rig.rate_hz));
    ASSERT_EQ(again.weights.size(), rig.weights.size());
    ASSERT_EQ(std::memcmp(again.weights.data(), rig.weights.data(), rig.weights.size() * sizeof(double)), 0);
    ASSERT_EQ(std::memcmp(again.lens.centre_mm.data(), rig.lens.centre_mm.data(), 2 * sizeof(double)), 0);
  }
}

TEST(Settings, print_the_meaning_and_the_bounds_of_each_key) {
  Rig rig;
  FieldList list;
  rig.fields(list);
  const std::string text = to_toml(list, 1);
  EXPECT_THAT(text, HasSubstr("schema = 1\n"));
  EXPECT_THAT(text, HasSubstr("# frames per second\n#   a finite number from 0 to 1e+06\nrate_hz = 100.0\n"));
  EXPECT_THAT(text, HasSubstr("\n[lens]\n"));
}

TEST(Settings, refuse_two_fields_of_one_name) {
  double value = 0;
  FieldList list;
  list.number("x", value, 0, 1, "");
  EXPECT_THROW(list.number("x", value, 0, 1, ""), Error);
}

}  // namespace
}  // namespace rptv
