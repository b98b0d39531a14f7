// SPDX-License-Identifier: MIT
// spdlog to stderr with two faces: the journal's and a person's.
#include "daemon/log.hpp"

#include <fmt/format.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/ansicolor_sink.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "core/error.hpp"

namespace rptv {
namespace {

constexpr std::array<std::pair<std::string_view, spdlog::level::level_enum>, 6> kLevels{{
    {"trace", spdlog::level::trace},
    {"debug", spdlog::level::debug},
    {"info", spdlog::level::info},
    {"warning", spdlog::level::warn},
    {"error", spdlog::level::err},
    {"off", spdlog::level::off},
}};

/// `%*`: the priority of syslog(3) in angle brackets, as sd-daemon(3) describes it.
class JournalPriority : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&, spdlog::memory_buf_t& out) override {
    static constexpr std::array<std::string_view, 7> kPriorities{"<7>", "<7>", "<6>", "<4>", "<3>", "<2>", "<6>"};
    const std::string_view priority = kPriorities.at(static_cast<std::size_t>(message.level));
    out.append(priority.data(), priority.data() + priority.size());
  }
  std::unique_ptr<custom_flag_formatter> clone() const override { return std::make_unique<JournalPriority>(); }
};

/// JOURNAL_STREAM is inherited by whatever a service starts; only the device and inode say whether stderr still is it.
bool stderr_is_the_journal() {
  const char* stream = std::getenv("JOURNAL_STREAM");
  struct stat status {};
  return stream != nullptr && fstat(STDERR_FILENO, &status) == 0 &&
         stream == fmt::format("{}:{}", status.st_dev, status.st_ino);
}

spdlog::level::level_enum parse_level(const std::string& word, std::string_view origin) {
  for (const auto& [name, level] : kLevels)
    if (name == word) return level;
  throw Error(ExitCode::usage,
              fmt::format("{}: unknown level '{}'; use one of trace, debug, info, warning, error, off", origin, word));
}

}  // namespace

void start_log(const std::string& level) {
  const char* from_environment = std::getenv("RPTV_LOG");
  const bool use_environment = level.empty() && from_environment != nullptr && *from_environment != '\0';
  const std::string word = use_environment ? from_environment : level.empty() ? "info" : level;
  const auto threshold = parse_level(word, use_environment ? "RPTV_LOG" : "--log-level");

  auto logger =
      std::make_shared<spdlog::logger>("rapidptv", std::make_shared<spdlog::sinks::ansicolor_stderr_sink_mt>());
  auto formatter = std::make_unique<spdlog::pattern_formatter>();
  if (stderr_is_the_journal())
    formatter->add_flag<JournalPriority>('*').set_pattern("%*%v");
  else
    formatter->set_pattern("%H:%M:%S.%e %^%l%$ %v");
  logger->set_formatter(std::move(formatter));
  logger->set_level(threshold);
  logger->flush_on(spdlog::level::trace);
  spdlog::set_default_logger(std::move(logger));
}

}  // namespace rptv
