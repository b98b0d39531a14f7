// SPDX-License-Identifier: MIT
// Truth comes out in the order of frames whichever thread was first, and counts what it wrote.
#include "daemon/truth_writer.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <thread>

namespace rptv {
namespace {

TEST(TruthWriter, keeps_frames_in_order_when_threads_do_not) {
  const auto file = std::filesystem::path(testing::TempDir()) / ("truth_" + std::to_string(getpid()) + ".csv");
  constexpr std::uint64_t kFrames = 400;
  {
    TruthWriter writer(file);
    std::atomic<std::uint64_t> next{0};
    std::vector<std::thread> threads;
    for (int i = 0; i < 4; ++i)
      threads.emplace_back([&] {
        for (std::uint64_t turn = next++; turn < kFrames; turn = next++) {
          const std::uint64_t frame = turn ^ 3U;  // four frames at a time, the last first
          std::vector<TruthRecord> records(frame % 3);
          for (std::uint64_t particle = 0; particle < records.size(); ++particle) {
            records[particle].row.frame = frame;
            records[particle].row.particle = particle;
            records[particle].row.in_view = particle == 0;
          }
          writer.deliver(frame, std::move(records));
        }
      });
    for (auto& thread : threads) thread.join();
    writer.close();
    EXPECT_EQ(writer.lit(), 399U);  // 133 rounds of 0 + 1 + 2, and frame 399 has none
    EXPECT_EQ(writer.in_view(), 266U);
  }
  std::uint64_t last = 0;
  const auto rows = read_truth(file);
  ASSERT_EQ(rows.size(), 399U);
  for (const auto& row : rows) {
    EXPECT_GE(row.frame, last);
    last = row.frame;
  }
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace rptv
