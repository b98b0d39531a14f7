// SPDX-License-Identifier: MIT
// Start, stop and status of a camera, from outside its threads.
#include "acquisition/aravis_camera.hpp"

#include <arv.h>
#include <pthread.h>

#include "acquisition/aravis_life.hpp"

namespace rptv {

AravisCamera::AravisCamera(const AravisSettings& settings, const std::string& name, std::uint32_t number,
                           std::size_t pool_frames)
    : life_(std::make_unique<Life>(settings, name, number, pool_frames)) {}

AravisCamera::~AravisCamera() { stop(); }

CameraInfo AravisCamera::info() const {
  const AravisSetup& setup = life_->setup;
  return {life_->name, setup.shape, setup.format->significant_bits, setup.bytes_behind_image};
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
  now.link += life_->ptp;
  now.counters.push_back({"delivered", life_->buffers.delivered()});
  if (life_->settings.trigger == "software") {
    now.counters.push_back({"triggers_fired", life_->trigger.fired()});
    now.counters.push_back({"triggers_skipped", life_->trigger.skipped()});
  }
  now.readings = life_->chunks.latest();
  now.last_outage = life_->buffers.last_outage();
  now.counters.push_back({"outages", now.last_outage.number});
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
