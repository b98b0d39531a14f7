// SPDX-License-Identifier: MIT
// Tables in and out: what is tolerated, what is refused with which words, and that nothing is lost on the way.
#include "core/csv.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <fstream>
#include <random>
#include <sstream>

#include "core/error.hpp"

namespace rptv {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::vector<CsvColumn> kColumns = {{"frame"}, {"x", {"x_mm"}}, {"note", {}, false}};

CsvReader reader(std::string_view text) { return CsvReader::from_text(text, "points.csv", kColumns); }

/// What reading every cell of `text` throws.
template <class Read>
std::string complaint(Read read) {
  try {
    read();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_data);
    EXPECT_THAT(error.what(), Not(HasSubstr("\n")));
    return error.what();
  }
  return "no error";
}

std::string complaint_of(std::string_view text) {
  return complaint([&] {
    CsvReader csv = reader(text);
    while (csv.next()) {
      csv.integer(0);
      csv.number(1);
    }
  });
}

class Csv : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("rptv-csv-" + std::to_string(::getpid()));
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

TEST_F(Csv, columns_are_found_by_name_in_any_order) {
  CsvReader csv = reader("y,x,frame\n7,1.5,3\n");
  ASSERT_TRUE(csv.next());
  EXPECT_EQ(csv.integer(0), 3);
  EXPECT_EQ(csv.number(1), 1.5);
  EXPECT_FALSE(csv.has(2));
  EXPECT_FALSE(csv.next());
}

TEST_F(Csv, an_alias_serves_where_the_name_is_absent) {
  CsvReader csv = reader("frame,x_mm\n3,1.5\n");
  ASSERT_TRUE(csv.next());
  EXPECT_EQ(csv.number(1), 1.5);
}

TEST_F(Csv, line_ends_blanks_quotes_and_marks_of_other_programs_are_tolerated) {
  CsvReader csv = reader("\xEF\xBB\xBF\"frame\", x ,note\r\n\r\n 3.0 ,\t+1.5,\"say \"\"a, b\"\"\"\r\n4,-2e-3,\n\n  \n");
  ASSERT_TRUE(csv.next());
  EXPECT_EQ(csv.integer(0), 3);
  EXPECT_EQ(csv.number(1), 1.5);
  EXPECT_EQ(csv.text(2), "say \"a, b\"");
  EXPECT_EQ(csv.line(), 3U);
  ASSERT_TRUE(csv.next());
  EXPECT_EQ(csv.number(1), -2e-3);
  EXPECT_EQ(csv.text(2), "");
  EXPECT_FALSE(csv.next());
}

TEST_F(Csv, the_last_line_needs_no_end) {
  CsvReader csv = reader("frame,x\n1,2");
  ASSERT_TRUE(csv.next());
  EXPECT_EQ(csv.number(1), 2);
  EXPECT_FALSE(csv.next());
}

TEST_F(Csv, a_bad_cell_is_named_with_file_line_column_and_value) {
  EXPECT_EQ(complaint_of("frame,x\n1,2\n2,abc\n"),
            "points.csv:3: column 'x' is 'abc', not a number; mend the cell or remove the row");
  EXPECT_THAT(complaint_of("frame,x\n1.5,2\n"), HasSubstr("points.csv:2: column 'frame' is '1.5', not an integer"));
  EXPECT_THAT(complaint_of("frame,x\n1,\n"), HasSubstr("column 'x' is '', not a number"));
  EXPECT_THAT(complaint_of("frame,x\n1,0x10\n"), HasSubstr("not a number"));
  EXPECT_THAT(complaint_of("frame,x\n1,1e999\n"), HasSubstr("beyond the range"));
  EXPECT_THAT(complaint_of("frame,x\n99999999999999999999,1\n"), HasSubstr("not an integer"));
}

TEST_F(Csv, not_a_number_and_infinity_are_refused_unless_asked_for) {
  for (const char* cell : {"nan", "NaN", "inf", "-Infinity"})
    EXPECT_THAT(complaint_of(std::string("frame,x\n1,") + cell + "\n"), HasSubstr("not finite")) << cell;
  CsvReader csv = reader("frame,x\n1,nan\n2,\n3,-inf\n");
  ASSERT_TRUE(csv.next());
  EXPECT_TRUE(std::isnan(csv.number_or_nan(1)));
  ASSERT_TRUE(csv.next());
  EXPECT_TRUE(std::isnan(csv.number_or_nan(1)));
  ASSERT_TRUE(csv.next());
  EXPECT_EQ(csv.number_or_nan(1), -INFINITY);
}

TEST_F(Csv, a_missing_column_is_named_with_the_header_that_was_found) {
  EXPECT_EQ(complaint_of("frame;x\n1;2\n"),
            "points.csv:1: no column 'frame'; the header is 'frame;x', columns are separated by commas");
  EXPECT_THAT(complaint_of("frame,x,x\n"), HasSubstr("two columns are named 'x'"));
}

TEST_F(Csv, an_empty_file_is_told_which_header_it_needs) {
  for (const char* text : {"", "\n", "\r\n\r\n", "\xEF\xBB\xBF"})
    EXPECT_EQ(complaint_of(text), "points.csv: is empty; the first line must name the columns frame,x");
  EXPECT_EQ(complaint_of("frame,x\n"), "no error");
}

TEST_F(Csv, a_row_of_another_width_is_refused) {
  EXPECT_THAT(complaint_of("frame,x\n1\n"), HasSubstr("points.csv:2: the row has 1 cells where the header has 2"));
  EXPECT_THAT(complaint_of("frame,x\n1,2,3\n"), HasSubstr("more cells where the header has 2"));
  EXPECT_THAT(complaint_of("frame,x\n1,\"2\n"), HasSubstr("not closed"));
  EXPECT_THAT(complaint_of("frame,x\n1,\"2\"3\n"), HasSubstr("text follows a quoted cell"));
}

TEST_F(Csv, a_line_beyond_one_mebibyte_is_refused_in_bounded_memory) {
  const std::string longest(CsvReader::kLongestLineBytes - 2, ' ');
  EXPECT_EQ(complaint_of("frame,x\n1," + longest.substr(1) + "2\n"), "no error");
  EXPECT_THAT(complaint_of("frame,x\n1," + longest + "23\n"), HasSubstr("points.csv:2: the line is longer than 1 MiB"));
  EXPECT_THAT(complaint([] { CsvReader("/dev/zero", kColumns); }), HasSubstr("/dev/zero:1: the line is longer"));
}

TEST_F(Csv, control_characters_and_long_cells_stay_out_of_messages) {
  const std::string message = complaint_of("frame,x\n1,\x1b[31m" + std::string(5000, 'a') + "\n");
  EXPECT_THAT(message, HasSubstr("'?[31maaa"));
  EXPECT_LT(message.size(), 200U);
}

TEST_F(Csv, files_that_cannot_be_opened_give_their_sysexits_code) {
  const auto code_of = [](const std::filesystem::path& file) {
    try {
      CsvReader csv(file, kColumns);
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr(file.string()));
      return error.code();
    }
    return ExitCode::ok;
  };
  EXPECT_EQ(code_of(folder_ / "absent.csv"), ExitCode::no_input);
  EXPECT_EQ(code_of(folder_), ExitCode::no_input);
}

TEST_F(Csv, doubles_come_back_bit_for_bit_over_many_buffers) {
  const auto file = folder_ / "doubles.csv";
  std::mt19937_64 random(7);
  std::vector<double> values;
  while (values.size() < 50'000) {
    const auto value = std::bit_cast<double>(random());
    if (std::isfinite(value)) values.push_back(value);
  }
  CsvWriter writer(file, "frame,x");
  for (std::size_t i = 0; i < values.size(); ++i) writer.index(i).number(values[i]).end_row();
  writer.close();
  CsvReader csv(file, kColumns);
  for (std::size_t i = 0; i < values.size(); ++i) {
    ASSERT_TRUE(csv.next());
    ASSERT_EQ(csv.index(0), i);
    ASSERT_EQ(std::bit_cast<std::uint64_t>(csv.number(1)), std::bit_cast<std::uint64_t>(values[i]));
  }
  EXPECT_FALSE(csv.next());
}

TEST_F(Csv, text_that_needs_quotes_gets_them) {
  const auto file = folder_ / "text.csv";
  CsvWriter writer(file, "frame,x,note");
  writer.integer(-1).number(0.1).text("a, \"b\"").end_row();
  writer.integer(2).number(1e300).text("plain").end_row();
  writer.close();
  EXPECT_EQ(content(file), "frame,x,note\n-1,0.1,\"a, \"\"b\"\"\"\n2,1e+300,plain\n");
}

TEST_F(Csv, a_full_disk_is_told_at_the_end_with_the_path) {
  CsvWriter writer("/dev/full", "frame,x");
  for (int i = 0; i < 20'000; ++i) writer.integer(i).number(i).end_row();
  EXPECT_FALSE(writer.ok());
  try {
    writer.close();
    FAIL() << "close() must throw";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::io);
    EXPECT_THAT(error.what(), HasSubstr("/dev/full"));
    EXPECT_THAT(error.what(), HasSubstr("No space left on device"));
  }
}

TEST_F(Csv, a_file_that_cannot_be_created_is_told_at_once) {
  try {
    CsvWriter writer(folder_ / "absent" / "tracks.csv", "frame");
    FAIL() << "the constructor must throw";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::io);
    EXPECT_THAT(error.what(), HasSubstr("create its folder first"));
  }
}

}  // namespace
}  // namespace rptv
