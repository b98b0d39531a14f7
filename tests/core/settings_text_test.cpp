// SPDX-License-Identifier: MIT
// Settings from a command line and as text: assignments, and printing that loses nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>

#include "core/error.hpp"
#include "tests/core/sample_rig.hpp"

namespace rptv {
namespace {

using ::testing::HasSubstr;

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

/// Tells -0 from 0, as == does not.
std::vector<std::uint64_t> bits_of(const std::vector<double>& values) {
  std::vector<std::uint64_t> bits;
  for (const double value : values) bits.push_back(std::bit_cast<std::uint64_t>(value));
  return bits;
}

TEST(SettingsText, are_set_one_by_one_from_a_command_line) {
  Rig rig;
  FieldList list;
  rig.fields(list);
  for (const char* assignment : {"memory=12", "rate_hz=1e3", "loop=true", "name=a=b c", "policy=lossless",
                                 "weights=1, 2.5,-3", "lens.centre_mm=[4,5]", "hosts=a , \"b,c\",d e"})
    set_field(list, assignment);
  EXPECT_EQ(rig.memory, 12);
  EXPECT_EQ(rig.rate_hz, 1000);
  EXPECT_TRUE(rig.loop);
  EXPECT_EQ(rig.name, "a=b c");
  EXPECT_EQ(rig.policy, "lossless");
  EXPECT_EQ(rig.weights, (std::vector<double>{1, 2.5, -3}));
  EXPECT_EQ(rig.lens.centre_mm, (std::vector<double>{4, 5}));
  EXPECT_EQ(rig.hosts, (std::vector<std::string>{"a", "b,c", "d e"}));
  set_field(list, "weights=");
  set_field(list, "hosts=[]");
  EXPECT_TRUE(rig.weights.empty());
  EXPECT_TRUE(rig.hosts.empty());
}

TEST(SettingsText, refuse_a_bad_assignment_from_a_command_line) {
  EXPECT_THAT(set_complaint("memory"), HasSubstr("has no '='"));
  EXPECT_THAT(set_complaint("memroy=1"), HasSubstr("did you mean 'memory'"));
  EXPECT_EQ(set_complaint("memory=1.5"), "--set 'memory=1.5': 'memory' must be an integer from 0 to 100");
  EXPECT_THAT(set_complaint("rate_hz=nan"), HasSubstr("finite number"));
  EXPECT_THAT(set_complaint("rate_hz=1x"), HasSubstr("finite number"));
  EXPECT_THAT(set_complaint("loop=yes"), HasSubstr("true or false"));
  EXPECT_THAT(set_complaint("lens.centre_mm=1"), HasSubstr("array of 2"));
  EXPECT_THAT(set_complaint("name=\xff"), HasSubstr("UTF-8"));
  EXPECT_THAT(set_complaint("hosts=\"a"), HasSubstr("an array of strings"));
  EXPECT_THAT(set_complaint("hosts=\"a\"b"), HasSubstr("an array of strings"));
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

TEST(SettingsText, come_back_bit_for_bit_from_their_own_text) {
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
    for (auto left = random() % 3; left > 0; --left) rig.hosts.push_back(any_text(random));
    FieldList list;
    rig.fields(list);
    read(again, to_toml(list, 1));
    ASSERT_EQ(again.name, rig.name);
    ASSERT_EQ(again.policy, rig.policy);
    ASSERT_EQ(again.memory, rig.memory);
    ASSERT_EQ(again.loop, rig.loop);
    ASSERT_EQ(std::bit_cast<std::uint64_t>(again.rate_hz), std::bit_cast<std::uint64_t>(rig.rate_hz));
    ASSERT_EQ(bits_of(again.weights), bits_of(rig.weights));
    ASSERT_EQ(again.hosts, rig.hosts);
    ASSERT_EQ(bits_of(again.lens.centre_mm), bits_of(rig.lens.centre_mm));
  }
}

TEST(SettingsText, print_the_meaning_and_the_bounds_of_each_key) {
  Rig rig;
  FieldList list;
  rig.fields(list);
  const std::string text = to_toml(list, 1);
  EXPECT_THAT(text, HasSubstr("schema = 1\n"));
  EXPECT_THAT(text, HasSubstr("# frames per second\n#   a finite number from 0 to 1e+06\nrate_hz = 100.0\n"));
  EXPECT_THAT(text, HasSubstr("\n[lens]\n"));
}

TEST(SettingsText, refuse_two_fields_of_one_name) {
  double value = 0;
  FieldList list;
  list.number("x", value, 0, 1, "");
  EXPECT_THROW(list.number("x", value, 0, 1, ""), Error);
}

}  // namespace
}  // namespace rptv
