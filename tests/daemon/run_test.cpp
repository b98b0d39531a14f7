// SPDX-License-Identifier: MIT
// The real daemon as a process: streams to a subscriber over ZeroMQ, drains when it is asked to stop, keeps every row.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <set>

#include "core/tables.hpp"
#include "daemon/live_listener.hpp"
#include "tests/daemon/small_run.hpp"

namespace rptv {
namespace {

pid_t start_daemon(const std::vector<std::string>& arguments) {
  std::vector<char*> words{const_cast<char*>("rapidptv")};
  for (const auto& word : arguments) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  const pid_t child = fork();
  if (child != 0) return child;
  alarm(120);
  execv(std::getenv("RAPIDPTV"), words.data());
  _exit(127);
}

class RunningDaemon : public ::testing::TestWithParam<int> {};

TEST_P(RunningDaemon, drains_and_keeps_every_published_row_when_asked_to_stop) {
  const testing::SmallRun run;
  const std::string endpoint = "ipc://" + (run.folder() / "live.sock").string();
  const auto tracks = run.folder() / "tracks.csv";
  LiveListener listener(endpoint);
  const pid_t daemon =
      start_daemon({"run", "--config", SimulatedRunFiles(run.folder()).rig, "--tracks", tracks, "--endpoint", endpoint,
                    "--wait-for-subscriber", "--log-level", "warning", "--set", "replay.loop=0"});
  constexpr int kPatienceMs = 30'000;
  while (listener.frames() < 60) ASSERT_TRUE(listener.poll(kPatienceMs));  // more frames than the recording has: looped
  ASSERT_EQ(kill(daemon, GetParam()), 0);
  int status = 0;
  while (waitpid(daemon, &status, WNOHANG) == 0) listener.poll(100);
  while (listener.poll(100)) {
  }
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_EQ(listener.missing_frames(), 0U);

  TracksReader reader(tracks);
  TrackRow row;
  std::uint64_t rows = 0;
  std::set<std::uint64_t> frames;
  for (; reader.next(row); ++rows) frames.insert(row.frame);
  EXPECT_GE(frames.size(), 60U);
  // A subscriber's queue and the writer see the same results.
  EXPECT_EQ(rows, listener.track_points());
}

INSTANTIATE_TEST_SUITE_P(Signals, RunningDaemon, ::testing::Values(SIGTERM, SIGINT));

}  // namespace
}  // namespace rptv
