// SPDX-License-Identifier: MIT
// The supervising thread of a camera: it opens what was lost, sets it up again and starts it.
#include "acquisition/aravis_camera.hpp"

#include <arv.h>
#include <pthread.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <thread>

#include "acquisition/aravis_link.hpp"
#include "acquisition/aravis_setup.hpp"
#include "acquisition/aravis_stream.hpp"
#include "acquisition/gvcp_probe.hpp"
#include "core/clock.hpp"
#include "core/error.hpp"
#include "core/wake.hpp"

namespace rptv {
namespace {

constexpr std::int64_t kRetry_ns = 300'000'000;
constexpr std::int64_t kLook_ns = 50'000'000;
constexpr unsigned kLooksPerSecond = 20;
constexpr std::int64_t kAnswer_ns = 150'000'000;
constexpr std::uint64_t kSearchEvery = 2;  // unanswered tries: a search delays an answer at the old address

void on_event(void* stream, ArvStreamCallbackType type, ArvBuffer*) noexcept {
  if (type == ARV_STREAM_CALLBACK_TYPE_INIT) static_cast<AravisStream*>(stream)->enter();
  if (type == ARV_STREAM_CALLBACK_TYPE_BUFFER_DONE) static_cast<AravisStream*>(stream)->done();
}

}  // namespace

struct AravisCamera::Life {
  const AravisSettings settings;
  const std::string name;
  CameraHandle camera;
  AravisSetup setup;
  GvcpIdentity identity;         // known for GigE Vision cameras
  std::uint64_t unanswered = 0;  // tries since it last answered
  AravisStream buffers;
  StreamHandle stream;  // guarded by `mutex` when it changes and when status() reads it
  std::atomic<bool> lost{false}, stopping{false};
  Wake wake;
  std::thread thread;
  mutable std::mutex mutex;
  DeviceStatus status;
  std::vector<DeviceCounter> past;  // what the streams of earlier sessions counted

  Life(const AravisSettings& s, const std::string& n, std::uint32_t number, std::size_t pool_frames)
      : settings(s),
        name(n),
        camera(open_camera(n)),
        setup(set_up_camera(camera.get(), n, s)),
        identity(who_answers_at(setup.address, kAnswer_ns)),
        buffers(number, setup.shape, *setup.format, pool_frames, std::clamp<std::size_t>(pool_frames / 2, 2, 32),
                s.thread_priority, setup.wide_ids ? FrameCounter::Width::bits64 : FrameCounter::Width::bits16) {
    status.device = setup.device;
  }

  void tell(DeviceState state, std::string problem) {
    const std::lock_guard lock(mutex);
    status.state = state;
    status.problem = std::move(problem);
  }

  bool wait(std::int64_t timeout_ns) noexcept {
    const std::int64_t deadline_ns = host_now_ns() + timeout_ns;
    for (;;) {
      const std::uint32_t seen = wake.prepare();
      const std::int64_t left_ns = deadline_ns - host_now_ns();
      if (stopping || lost || left_ns <= 0) return !stopping;
      wake.wait(seen, left_ns);
    }
  }

  bool answers() const { return who_answers_at(setup.address, kAnswer_ns) == identity; }
  void look_for_it();
  void open_again() {
    if (identity.known()) look_for_it();
    camera = open_camera(identity.known() ? setup.address : name);
    const AravisSetup now = set_up_camera(camera.get(), name, settings);
    if (now.shape != setup.shape)
      throw Error(ExitCode::configuration, "camera " + name + " came back with another image size; restart rapidptv");
    setup = now;
    const std::lock_guard lock(mutex);
    status.device = setup.device;
  }

  bool has_control() const {
    return !arv_camera_is_gv_device(camera.get()) ||
           arv_gv_device_is_controller(ARV_GV_DEVICE(arv_camera_get_device(camera.get())));
  }

  static void on_lost(ArvDevice*, gpointer self) {
    auto* life = static_cast<Life*>(self);
    life->lost = true;
    life->wake.notify();
  }

  void begin_session(FrameSink& sink);
  void end_session() noexcept;
  void supervise(FrameSink& sink) noexcept;
};

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
  const std::string socket = tune_stream(camera.get(), made.get(), settings);
  lost = false;
  // Not with GigE Vision: Aravis' heartbeat thread tells with a reference in its hand, and when ours goes meanwhile,
  // that thread destroys the device, waits for itself and aborts the process. There has_control() is asked.
  if (!arv_camera_is_gv_device(camera.get()))
    g_signal_connect(arv_camera_get_device(camera.get()), "control-lost", G_CALLBACK(&Life::on_lost), this);
  {
    const std::lock_guard lock(mutex);
    stream = std::move(made);
    status.link = setup.text() + socket + (settings.trigger == "off" ? "" : ", trigger " + settings.trigger) +
                  (buffers.priority_refused() ? ", real-time priority refused" : "");
  }
  buffers.begin(stream.get(), sink, setup.period_ns);
  arv_camera_start_acquisition(camera.get(), failure.out());
  if (failure) throw Error(ExitCode::unavailable, "camera " + name + " does not start (" + failure.text() + ")");
  const std::lock_guard lock(mutex);
  ++status.sessions;
  status.state = DeviceState::streaming;
  status.problem.clear();
}

void AravisCamera::Life::end_session() noexcept {
  ArvFailure ignored;
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
  if (camera)
    g_signal_handlers_disconnect_by_func(arv_camera_get_device(camera.get()),
                                         reinterpret_cast<gpointer>(reinterpret_cast<void (*)()>(&Life::on_lost)),
                                         this);
  camera.reset();
}

void AravisCamera::Life::supervise(FrameSink& sink) noexcept {
  while (!stopping) {
    try {
      if (!camera) open_again();
      begin_session(sink);
      for (unsigned look = 1; !lost && wait(kLook_ns); ++look) {
        if (!has_control()) lost = true;
        if (look % kLooksPerSecond == 0) clear_packet_socket_errors();
      }
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

AravisCamera::AravisCamera(const AravisSettings& settings, const std::string& name, std::uint32_t number,
                           std::size_t pool_frames)
    : life_(std::make_unique<Life>(settings, name, number, pool_frames)) {}

AravisCamera::~AravisCamera() { stop(); }

CameraInfo AravisCamera::info() const {
  return {life_->name, life_->setup.shape, life_->setup.format->significant_bits};
}

std::int64_t AravisCamera::period_ns() const noexcept { return life_->setup.period_ns; }

void AravisCamera::start(FrameSink& sink) {
  if (life_->thread.joinable()) return;
  life_->tell(DeviceState::connecting, "");
  life_->thread = std::thread([life = life_.get(), &sink] { life->supervise(sink); });
  pthread_setname_np(life_->thread.native_handle(), "rptv-camera");
}

void AravisCamera::ask_to_stop() noexcept {
  life_->stopping = true;
  life_->buffers.leave();
  life_->wake.notify();
}

void AravisCamera::stop() noexcept {
  ask_to_stop();
  if (life_->thread.joinable()) life_->thread.join();
}

DeviceStatus AravisCamera::status() const {
  const std::lock_guard lock(life_->mutex);
  DeviceStatus now = life_->status;
  now.counters.push_back({"delivered", life_->buffers.delivered()});
  now.counters.push_back({"outages", life_->buffers.outages()});
  now.counters.push_back({"outage_ms", static_cast<std::uint64_t>(life_->buffers.outage_ns() / 1'000'000)});
  for (std::size_t i = 0; i < AravisStream::kStatuses; ++i)
    now.counters.push_back({std::string("unfit_") + AravisStream::status_name(i), life_->buffers.unfit(i)});
  ArvStream* stream = life_->stream.get();
  for (guint i = 0; stream != nullptr && i < arv_stream_get_n_infos(stream); ++i)
    if (arv_stream_get_info_type(stream, i) == G_TYPE_UINT64)
      now.counters.push_back(
          {arv_stream_get_info_name(stream, i),
           arv_stream_get_info_uint64(stream, i) + (i < life_->past.size() ? life_->past[i].count : 0)});
  return now;
}

}  // namespace rptv
