// SPDX-License-Identifier: MIT
// Tables are written and read without an allocation per row, however long the table is.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "core/tables.hpp"
#include "tests/core/allocation_counter.hpp"

namespace rptv {
namespace {

constexpr std::uint64_t kFrames = 2000;

TEST(TableMemory, is_taken_before_the_first_row) {
  if (!AllocationCounter::kCounts) GTEST_SKIP() << "a sanitizer owns the allocator";
  const auto file = std::filesystem::temp_directory_path() / ("rptv-rows-" + std::to_string(::getpid()) + ".csv");
  Tracks tracks(20);
  for (std::uint64_t i = 0; i < 20; ++i) tracks.push({.particle = i, .x_mm = 0.1 * static_cast<double>(i)});
  TracksWriter writer(file);
  AllocationCounter writing;
  for (std::uint64_t frame = 0; frame < kFrames; ++frame)
    writer.write(frame, 0.01 * static_cast<double>(frame), tracks);
  EXPECT_EQ(writing.disarm(), 0U);
  writer.close();

  TracksReader reader(file);
  TrackRow row;
  ASSERT_TRUE(reader.next(row));
  std::uint64_t rows = 1;
  AllocationCounter reading;
  while (reader.next(row)) ++rows;
  EXPECT_EQ(reading.disarm(), 0U);
  EXPECT_EQ(rows, kFrames * tracks.size());
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace rptv
