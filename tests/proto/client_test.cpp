// SPDX-License-Identifier: MIT
// The programs that users watch the stream with, docs/clients/tracks.py and `rapidptv tail`, against the real
// publisher.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <fstream>
#include <regex>
#include <sstream>
#include <thread>

#include "core/error.hpp"
#include "daemon/publisher.hpp"
#include "tests/proto/made_result.hpp"
#include "tests/proto/place.hpp"

namespace rptv {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

struct Outcome {
  int code = -1;
  std::string out, err;
};

std::string read_file(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

/// Publishes frames of 3 tracks (x of track i is i/4 mm) from its own thread while programs run against it.
class Client : public ::testing::Test {
 protected:
  Client() {
    PublisherSettings settings;
    settings.endpoint = place_.ipc();
    publisher_ = std::make_unique<Publisher>(
        settings,
        PublisherContent{.particle_capacity = 8, .track_capacity = 8, .calibration_text = "c", .config_text = "s"},
        losses_, nullptr);
    publisher_->start();
  }

  void publish_one(std::uint64_t frame) {
    ResultLease lease = pool_.claim();
    if (!lease) return;
    fill_result(*lease, frame, 3);
    lease->tracks.x_mm = {0.25, 0.5, 0.75};
    lease->tracks.push_death(99);
    publisher_->publish(std::move(lease));
  }

  /// Runs a shell command, publishing until it ends; `on_output` is called once when it has printed something.
  Outcome run(const std::string& command, int signal = 0) {
    const std::string out = place_.file("out").string(), err = place_.file("err").string();
    std::ofstream(out).close();
    const pid_t child = fork();
    if (child == 0) {
      const std::string shell = "exec " + command + " >" + out + " 2>" + err;
      execl("/bin/sh", "sh", "-c", shell.c_str(), nullptr);
      _exit(127);
    }
    int status = 0;
    std::uint64_t frame = 0;
    bool signalled = false;
    const bool ended = eventually([&] {
      publish_one(frame++);
      std::this_thread::yield();
      if (signal != 0 && !signalled && std::filesystem::file_size(out) > 0) signalled = kill(child, signal) == 0;
      return waitpid(child, &status, WNOHANG) == child;
    });
    EXPECT_TRUE(ended) << command;
    if (!ended) {
      kill(child, SIGKILL);
      waitpid(child, &status, 0);
    }
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_file(out), read_file(err)};
  }

  std::string tail(const std::string& arguments) const {
    return std::string(RPTV_BINARY) + " tail " + place_.ipc() + " " + arguments;
  }
  std::string python() const {
    return "env PYTHONPATH=" RPTV_PYTHON_WIRE_DIR ":" RPTV_SOURCE_DIR "/docs/clients " RPTV_PYTHON " -u ";
  }

  const Place place_;
  Losses losses_;
  ResultPool pool_{16, [] { return Result(8, 8); }};
  std::unique_ptr<Publisher> publisher_;
};

TEST_F(Client, in_python_gets_the_published_arrays) {
  const auto script = place_.write("check.py", R"(
import itertools, sys
import numpy as np
from tracks import live_tracks
last = -1
for frame, t, tracks in itertools.islice(live_tracks(sys.argv[1]), 5):
    assert frame > last and abs(t - frame * 0.01) < 1e-9
    last = frame
    assert tracks["id"].tolist() == [1, 2, 3] and tracks["id"].dtype == np.uint64
    assert tracks["x"].tolist() == [0.25, 0.5, 0.75] and tracks["x"].dtype == np.float32
    assert tracks["age"].tolist() == [0, 1, 2]
    assert all(len(column) == 3 for column in tracks.values()) and len(tracks) == 9
print("five frames")
)");
  const Outcome outcome = run(python() + script.string() + " " + place_.ipc());
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "five frames\n");
}

TEST_F(Client, in_python_prints_a_line_per_frame) {
  const Outcome outcome = run(python() + RPTV_SOURCE_DIR "/docs/clients/tracks.py " + place_.ipc(), SIGTERM);
  EXPECT_TRUE(std::regex_search(outcome.out, std::regex("^frame \\d+  t \\d+\\.\\d{6} s  3 tracks\n"))) << outcome.out;
}

TEST(PythonClient, has_at_most_30_lines) {
  std::ifstream file(RPTV_SOURCE_DIR "/docs/clients/tracks.py");
  int lines = 0;
  for (std::string line; std::getline(file, line);) ++lines;
  EXPECT_GT(lines, 0);
  EXPECT_LE(lines, 30);
}

TEST_F(Client, tail_prints_a_line_per_frame) {
  const Outcome outcome = run(tail("--count 3"));
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const std::string line = "frame \\d+  t \\d+\\.\\d{6} s  tracks 3  births 1  deaths 1  latency \\d+\\.\\d{3} ms\n";
  EXPECT_TRUE(std::regex_match(outcome.out, std::regex("(" + line + "){3}"))) << outcome.out;
}

TEST_F(Client, tail_prints_json_that_python_reads) {
  const Outcome outcome = run(tail("--json --count 2 --topic tracks,particles,status,rig"));
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  place_.write("lines.json", outcome.out);
  const Outcome parsed = run(python() + "-c 'import json; print(len([json.loads(l) for l in open(\"" +
                             place_.file("lines.json").string() + "\")]))'");
  EXPECT_EQ(parsed.out, "2\n") << parsed.err;
}

TEST_F(Client, tail_prints_latencies_to_the_subscriber_at_the_end) {
  const Outcome outcome = run(tail("--latency --count 20"));
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  for (const char* row : {"P99.9 ms", "arrived", "bundled", "reconstructed", "linked", "published", "received"})
    EXPECT_THAT(outcome.out, HasSubstr(row));
}

TEST_F(Client, tail_ends_with_0_on_ctrl_c) {
  const Outcome outcome = run(tail(""), SIGINT);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("tracks 3"));
}

TEST_F(Client, tail_says_when_nothing_came) {
  const Outcome outcome = run(std::string(RPTV_BINARY) + " tail " + place_.ipc("nobody.sock") + " --timeout 0.2");
  EXPECT_EQ(outcome.code, static_cast<int>(ExitCode::unavailable));
  EXPECT_THAT(outcome.out, IsEmpty());
  EXPECT_THAT(outcome.err, HasSubstr("nobody.sock: nothing came within 0.2 s; start `rapidptv run`"));
}

}  // namespace
}  // namespace rptv
