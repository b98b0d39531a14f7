// SPDX-License-Identifier: MIT
// Drawing of the progress bar.
#include "daemon/progress.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/clock.hpp"

namespace rptv {

namespace {

constexpr std::int64_t kQuietNs = 500'000'000;
constexpr std::int64_t kRedrawNs = 100'000'000;
constexpr std::size_t kBarColumns = 24;

std::string time_left(double seconds) {
  if (!(seconds < 100 * 3600)) return "-:--";
  const auto whole = static_cast<long>(std::ceil(seconds));
  if (whole < 3600) return fmt::format("{}:{:02}", whole / 60, whole % 60);
  return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

std::size_t terminal_columns() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

}  // namespace

std::string progress_line(const std::string& what, std::uint64_t done, std::uint64_t total, double elapsed_s,
                          std::size_t columns) {
  const double share = total == 0 ? 1.0 : std::min(1.0, static_cast<double>(done) / static_cast<double>(total));
  const double rate = elapsed_s > 0 ? static_cast<double>(done) / elapsed_s : 0.0;
  const auto filled = static_cast<std::size_t>(share * static_cast<double>(kBarColumns));
  const std::string bar = std::string(filled, '#') + std::string(kBarColumns - filled, '.');
  const double left = rate > 0 ? static_cast<double>(total - std::min(done, total)) / rate : INFINITY;
  std::string line = fmt::format("{} [{}] {:3.0f} % {}/{}  {:.3g}/s  {} left", what, bar, std::floor(100 * share), done,
                                 total, rate, time_left(left));
  if (line.size() > columns) line.resize(columns);
  return line;
}

Progress::Progress(std::string what, std::uint64_t total)
    : what_(std::move(what)),
      total_(total),
      terminal_(isatty(STDERR_FILENO) != 0),
      start_ns_(host_now_ns()),
      next_ns_(start_ns_ + kQuietNs) {}

Progress::~Progress() {
  if (drawn_) std::fputs("\r\033[K", stderr);
}

void Progress::advance(std::uint64_t steps) {
  const std::uint64_t done = done_.fetch_add(steps, std::memory_order_relaxed) + steps;
  if (!terminal_) return;
  const std::int64_t now_ns = host_now_ns();
  if (now_ns < next_ns_.load(std::memory_order_relaxed)) return;
  const std::unique_lock lock(drawing_, std::try_to_lock);
  if (lock) draw(done, now_ns);
}

void Progress::draw(std::uint64_t done, std::int64_t now_ns) {
  next_ns_.store(now_ns + kRedrawNs, std::memory_order_relaxed);
  const double elapsed_s = 1e-9 * static_cast<double>(now_ns - start_ns_);
  const std::string line = progress_line(what_, done, total_, elapsed_s, terminal_columns() - 1);
  std::fprintf(stderr, "\r\033[K%s", line.c_str());
  std::fflush(stderr);
  drawn_ = true;
}

}  // namespace rptv
