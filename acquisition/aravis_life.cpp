// SPDX-License-Identifier: MIT
// The supervising thread of a camera: it opens what was lost, sets it up again and starts it.
#include "acquisition/aravis_life.hpp"

#include <arv.h>

#include <algorithm>

#include "acquisition/aravis_link.hpp"
#include "core/clock.hpp"
#include "core/error.hpp"

namespace rptv {
namespace {

constexpr std::int64_t kRetry_ns = 300'000'000;
constexpr std::int64_t kLook_ns = 100'000'000;
constexpr unsigned kLooksPerSecond = 10;
constexpr std::int64_t kAnswer_ns = 150'000'000;
constexpr std::int64_t kReading_ns = 500'000'000, kBetweenLooks_ns = 5'000'000;
constexpr int kAsleep = 10;                // looks
constexpr std::uint64_t kSearchEvery = 2;  // unanswered tries: a search delays an answer at the old address

void on_event(void* stream, ArvStreamCallbackType type, ArvBuffer*) noexcept {
  if (type == ARV_STREAM_CALLBACK_TYPE_INIT) static_cast<AravisStream*>(stream)->enter();
  if (type == ARV_STREAM_CALLBACK_TYPE_BUFFER_DONE) static_cast<AravisStream*>(stream)->done();
}

void mark_lost(ArvDevice*, gpointer lost) noexcept { *static_cast<std::atomic<bool>*>(lost) = true; }

}  // namespace

AravisCamera::Life::Life(const AravisSettings& s, const std::string& n, std::uint32_t number, std::size_t pool_frames)
    : settings(s),
      name(n),
      camera(open_camera(n)),
      setup(set_up_camera(camera.get(), n, s)),
      identity(who_answers_at(setup.address, kAnswer_ns)),
      trigger(s.trigger == "software" ? setup.period_ns : 0),
      chunks(camera.get(), n, s.chunks),
      buffers(number, setup, chunks, pool_frames, std::clamp<std::size_t>(pool_frames / 2, 2, 32), s.thread_priority) {
  status.device = setup.device;
}

void AravisCamera::Life::tell(DeviceState state, std::string problem) {
  const std::lock_guard lock(mutex);
  status.state = state;
  status.problem = std::move(problem);
}

void AravisCamera::Life::show_ptp(const PtpState& now) {
  buffers.set_clock(now.locked() ? ClockId::ptp : ClockId::device);
  const std::lock_guard lock(mutex);
  ptp = now.text();
}

bool AravisCamera::Life::wait(std::int64_t timeout_ns) noexcept {
  const std::int64_t deadline_ns = host_now_ns() + timeout_ns;
  for (;;) {
    const std::uint32_t seen = wake.prepare();
    const std::int64_t left_ns = deadline_ns - host_now_ns();
    if (stopping || lost || left_ns <= 0) return !stopping;
    wake.wait(seen, left_ns);
  }
}

bool AravisCamera::Life::answers() const { return who_answers_at(setup.address, kAnswer_ns) == identity; }

bool AravisCamera::Life::has_control() const {
  return !arv_camera_is_gv_device(camera.get()) ||
         arv_gv_device_is_controller(ARV_GV_DEVICE(arv_camera_get_device(camera.get())));
}

void AravisCamera::Life::open_again() {
  if (identity.known()) look_for_it();
  camera = open_camera(identity.known() ? setup.address : name);
  const AravisSetup now = set_up_camera(camera.get(), name, settings);
  if (now.shape != setup.shape || now.bytes_behind_image != setup.bytes_behind_image)
    throw Error(ExitCode::configuration, "camera " + name + " came back with another image size; restart rapidptv");
  setup = now;
  const std::lock_guard lock(mutex);
  status.device = setup.device;
}

// Opening an absent camera would block for 2.5 s, and the opening of every other camera with it: so ask first. One that
// has another address since it was switched on again is known by its hardware address and serial number.
void AravisCamera::Life::look_for_it() {
  if (answers()) {
    unanswered = 0;
    return;
  }
  if (++unanswered % kSearchEvery == 0) {
    const std::string found = find_address_of(identity, kAnswer_ns);
    if (!found.empty()) setup.address = found;
    if (!found.empty()) return;
  }
  throw Error(ExitCode::unavailable, "camera " + name + " does not answer at " + setup.address +
                                         " nor elsewhere; it is looked for: check power, cable and address");
}

void AravisCamera::Life::begin_session(FrameSink& sink) {
  ArvFailure failure;
  choose_socket(camera.get(), settings);
  StreamHandle made(arv_camera_create_stream(camera.get(), &on_event, &buffers, failure.out()));
  if (!made)
    throw Error(ExitCode::unavailable, "camera " + name + " gives no stream (" + failure.text() +
                                           "); close the other program that controls it");
  if (settings.ptp)
    show_ptp(wait_for_ptp(camera.get(), name, settings.ptp_wait_s, [this](std::int64_t ns) { return wait(ns); }));
  const std::string socket = tune_stream(camera.get(), made.get(), settings);
  lost = false;
  // Not with GigE Vision: Aravis' heartbeat thread tells with a reference in its hand, and when ours goes meanwhile,
  // that thread destroys the device, waits for itself and aborts the process. There has_control() is asked.
  if (!arv_camera_is_gv_device(camera.get()))
    g_signal_connect(arv_camera_get_device(camera.get()), "control-lost", G_CALLBACK(&mark_lost), &lost);
  {
    const std::lock_guard lock(mutex);
    stream = std::move(made);
    status.link = setup.text() + socket + (settings.trigger == "off" ? "" : ", trigger " + settings.trigger) +
                  (buffers.priority_refused() ? ", real-time priority refused" : "");
  }
  chunks.ask();
  buffers.begin(stream.get(), sink, setup.period_ns);
  arv_camera_start_acquisition(camera.get(), failure.out());
  if (failure) throw Error(ExitCode::unavailable, "camera " + name + " does not start (" + failure.text() + ")");
  trigger.begin(host_now_ns());
  const std::lock_guard lock(mutex);
  ++status.sessions;
  status.state = DeviceState::streaming;
  status.problem.clear();
}

// A stream that is closed drops what lies unread with the kernel, uncounted. A receiving thread that sleeps has read
// all that it was told of; the kernel tells 5 ms late, and later when it is busy, so it must sleep for a while.
void AravisCamera::Life::let_it_read() const {
  const std::int64_t deadline_ns = host_now_ns() + kReading_ns;
  Wake nobody;
  for (int asleep = 0; asleep < kAsleep && host_now_ns() < deadline_ns;) {
    nobody.wait(nobody.prepare(), kBetweenLooks_ns);
    asleep = buffers.asleep() ? asleep + 1 : 0;
  }
}

void AravisCamera::Life::end_session() noexcept {
  ArvFailure ignored;
  if (stream && !stopping) let_it_read();
  // To one that is gone unnoticed, every word would take 2.5 s.
  if (camera && stream && !lost && (!identity.known() || answers()))
    arv_camera_stop_acquisition(camera.get(), ignored.out());
  StreamHandle old;
  {
    const std::lock_guard lock(mutex);
    old = std::move(stream);
    if (old)
      for (guint i = 0; i < arv_stream_get_n_infos(old.get()); ++i) {
        if (arv_stream_get_info_type(old.get(), i) != G_TYPE_UINT64) continue;
        if (past.size() <= i) past.resize(i + 1);
        past[i].count += arv_stream_get_info_uint64(old.get(), i);
      }
  }
  old.reset();  // joins the receiving thread
  if (camera) g_signal_handlers_disconnect_by_data(arv_camera_get_device(camera.get()), &lost);
  camera.reset();
}

void AravisCamera::Life::look_after_it() {
  const std::vector<int> sockets = packet_sockets();
  std::int64_t look_ns = host_now_ns() + kLook_ns;
  for (unsigned looks = 0; !lost && wait(std::min(look_ns, trigger.due_ns()) - host_now_ns());) {
    if (!trigger.fire(camera.get(), host_now_ns())) lost = true;
    if (host_now_ns() < look_ns) continue;
    look_ns = host_now_ns() + kLook_ns;
    if (!has_control()) lost = true;
    if (++looks % kLooksPerSecond != 0) continue;
    clear_errors(sockets);
    chunks.ask();
    if (settings.ptp) show_ptp(read_ptp(camera.get()));
  }
}

void AravisCamera::Life::supervise(FrameSink& sink) noexcept {
  while (!stopping) {
    try {
      if (!camera) open_again();
      begin_session(sink);
      look_after_it();
      if (!stopping)
        tell(DeviceState::lost, "camera " + name + " stopped answering; it is opened again: check cable and power");
      end_session();
      lost = false;
    } catch (const std::exception& error) {
      tell(DeviceState::lost, error.what());
      end_session();
      lost = false;
      wait(kRetry_ns);
    }
  }
  buffers.end();
  tell(DeviceState::stopped, "");
}

}  // namespace rptv
