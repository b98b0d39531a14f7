// SPDX-License-Identifier: MIT
// Signals through an eventfd, reports through sd_notify.
#include "daemon/supervisor.hpp"

#include <systemd/sd-daemon.h>

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "core/clock.hpp"
#include "core/error.hpp"

namespace rptv {
namespace {

constexpr std::int64_t kSecondNs = 1'000'000'000;
constexpr std::int64_t kSecondSignalAfterNs = kSecondNs / 10;
constexpr int kStopNowCode = 130;  // 128 + SIGINT, as shells report it

/// What a signal handler may touch: lock-free atomics and a descriptor.
struct StopRequest {
  std::atomic<std::int64_t> asked_ns{0};  ///< CLOCK_MONOTONIC of the first request; 0: none
  int event = -1;

  void ask() noexcept {
    std::int64_t none = 0;
    if (!asked_ns.compare_exchange_strong(none, host_now_ns(), std::memory_order_acq_rel)) return;
    const std::uint64_t one = 1;
    if (write(event, &one, sizeof one) < 0) return;  // the counter cannot be full: it is written once
  }
  bool asked() const noexcept { return asked_ns.load(std::memory_order_acquire) != 0; }
};
static_assert(std::atomic<std::int64_t>::is_always_lock_free && std::atomic<StopRequest*>::is_always_lock_free);

std::atomic<StopRequest*> active{nullptr};

extern "C" void on_stop_signal(int signal) {
  const int saved_errno = errno;
  if (StopRequest* request = active.load(std::memory_order_acquire)) {
    const std::int64_t asked_ns = request->asked_ns.load(std::memory_order_acquire);
    if (signal == SIGINT && asked_ns != 0 && host_now_ns() - asked_ns > kSecondSignalAfterNs) _exit(kStopNowCode);
    request->ask();
  }
  errno = saved_errno;
}

}  // namespace

struct Supervisor::State {
  StopRequest request;
  struct sigaction old_term {
  }, old_int{};
  bool stop_reported = false;
  std::int64_t watchdog_interval_ns = 0;
  std::int64_t fed_ns = 0;
  std::uint64_t work_when_fed = 0;
  std::string status_sent;
  std::int64_t status_sent_ns = 0;
};

Supervisor::Supervisor() : state_(std::make_unique<State>()) {
  StopRequest& request = state_->request;
  request.event = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (request.event < 0)
    throw Error(ExitCode::internal, std::string("eventfd: ") + std::strerror(errno) + "; raise LimitNOFILE");
  StopRequest* none = nullptr;
  if (!active.compare_exchange_strong(none, &request, std::memory_order_acq_rel)) {
    close(request.event);
    throw Error(ExitCode::internal, "a second Supervisor was made in one process; please report it");
  }
  struct sigaction action {};
  action.sa_handler = on_stop_signal;
  action.sa_flags = SA_RESTART;
  sigaction(SIGTERM, &action, &state_->old_term);
  sigaction(SIGINT, &action, &state_->old_int);
  std::uint64_t watchdog_us = 0;
  if (sd_watchdog_enabled(0, &watchdog_us) > 0)
    state_->watchdog_interval_ns = static_cast<std::int64_t>(watchdog_us) * 1000 / 2;
}

Supervisor::~Supervisor() {
  sigaction(SIGTERM, &state_->old_term, nullptr);
  sigaction(SIGINT, &state_->old_int, nullptr);
  active.store(nullptr, std::memory_order_release);
  close(state_->request.event);
}

bool Supervisor::wait(std::int64_t timeout_ns) noexcept {
  const std::int64_t until_ns = host_now_ns() + timeout_ns;
  // A descriptor of -1 is never ready: once the caller knows of the stop, this is a plain sleep.
  pollfd waits{state_->stop_reported ? -1 : state_->request.event, POLLIN, 0};
  int ready = 0;
  for (std::int64_t left_ns = timeout_ns; ready <= 0 && left_ns > 0; left_ns = until_ns - host_now_ns()) {
    const timespec left{left_ns / kSecondNs, left_ns % kSecondNs};
    ready = ppoll(&waits, 1, &left, nullptr);  // -1 when a signal came: look again
  }
  return state_->stop_reported = stop_requested();
}

void Supervisor::request_stop() noexcept { state_->request.ask(); }

bool Supervisor::stop_requested() const noexcept { return state_->request.asked(); }

void Supervisor::ready() noexcept {
  state_->fed_ns = host_now_ns();
  sd_notify(0, "READY=1\nWATCHDOG=1");
}

void Supervisor::status(const std::string& text) noexcept {
  const std::int64_t now_ns = host_now_ns();
  if (text == state_->status_sent) return;
  if (state_->status_sent_ns != 0 && now_ns - state_->status_sent_ns < kSecondNs) return;
  sd_notifyf(0, "STATUS=%s", text.c_str());
  state_->status_sent = text;
  state_->status_sent_ns = now_ns;
}

void Supervisor::progress(std::uint64_t work_done, bool idle) noexcept {
  const std::int64_t now_ns = host_now_ns();
  if (state_->watchdog_interval_ns == 0 || now_ns - state_->fed_ns < state_->watchdog_interval_ns) return;
  if (!idle && work_done == state_->work_when_fed) return;
  sd_notify(0, "WATCHDOG=1");
  state_->fed_ns = now_ns;
  state_->work_when_fed = work_done;
}

void Supervisor::stopping() noexcept { sd_notify(0, "STOPPING=1\nSTATUS=draining"); }

std::int64_t Supervisor::watchdog_interval_ns() const noexcept { return state_->watchdog_interval_ns; }

}  // namespace rptv
