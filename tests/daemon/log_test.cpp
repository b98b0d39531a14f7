// SPDX-License-Identifier: MIT
// What reaches stderr, with and without the journal behind it.
#include "daemon/log.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include "core/error.hpp"

namespace rptv {
namespace {

/// Points descriptor 2 to a file, which stands for the journal's stream, and gives it back at the end.
class CapturedStderr {
 public:
  CapturedStderr() : saved_(dup(STDERR_FILENO)) {
    const int file = mkstemp(path_);
    dup2(file, STDERR_FILENO);
    close(file);
  }
  ~CapturedStderr() {
    dup2(saved_, STDERR_FILENO);
    close(saved_);
    unlink(path_);
    unsetenv("JOURNAL_STREAM");
    unsetenv("RPTV_LOG");
  }
  /// Claims, as the service manager does, that stderr is the journal.
  void announce_as_journal() const {
    struct stat status {};
    fstat(STDERR_FILENO, &status);
    setenv("JOURNAL_STREAM", (std::to_string(status.st_dev) + ":" + std::to_string(status.st_ino)).c_str(), 1);
  }
  std::string text() const {
    std::ifstream file(path_);
    std::stringstream all;
    all << file.rdbuf();
    return all.str();
  }

 private:
  char path_[32] = "/tmp/rptv-log-XXXXXX";
  int saved_;
};

TEST(Log, carries_priorities_where_the_journal_reads) {
  CapturedStderr captured;
  captured.announce_as_journal();
  start_log("debug");
  spdlog::error("camera 2 is gone");
  spdlog::warn("late");
  spdlog::info("ready");
  spdlog::debug("slot 3");
  EXPECT_EQ(captured.text(), "<3>camera 2 is gone\n<4>late\n<6>ready\n<7>slot 3\n");
}

TEST(Log, carries_time_and_level_for_a_person) {
  CapturedStderr captured;
  start_log("");
  spdlog::debug("not shown");
  spdlog::warn("camera 2 is gone");
  EXPECT_NE(captured.text().find("warning camera 2 is gone\n"), std::string::npos) << captured.text();
  EXPECT_EQ(captured.text().find("not shown"), std::string::npos);
}

TEST(Log, does_not_take_an_inherited_journal_stream_for_its_own) {
  CapturedStderr captured;
  setenv("JOURNAL_STREAM", "8:1", 1);
  start_log("info");
  spdlog::error("x");
  EXPECT_EQ(captured.text().find("<3>"), std::string::npos);
  EXPECT_NE(captured.text().find("error x"), std::string::npos);
}

TEST(Log, takes_its_level_from_the_environment_unless_told) {
  CapturedStderr captured;
  setenv("RPTV_LOG", "error", 1);
  start_log("");
  spdlog::warn("hidden");
  start_log("debug");
  spdlog::debug("shown");
  EXPECT_EQ(captured.text().find("hidden"), std::string::npos);
  EXPECT_NE(captured.text().find("shown"), std::string::npos);
}

TEST(Log, refuses_an_unknown_level_and_names_the_known_ones) {
  try {
    start_log("loud");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::usage);
    EXPECT_EQ(std::string(error.what()),
              "--log-level: unknown level 'loud'; use one of trace, debug, info, warning, error, off");
  }
}

}  // namespace
}  // namespace rptv
