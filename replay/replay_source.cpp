// SPDX-License-Identifier: MIT
// Set-up, start and stop of a replay.
#include "replay/replay_source.hpp"

#include <pthread.h>

#include <algorithm>

#include "core/error.hpp"

namespace rptv {
namespace {

/// From start() to the first deadline: time for the threads to begin and to fill their first slots.
constexpr std::int64_t kLeadIn_ns = 20'000'000;

std::uint32_t bits_of(const ImageSequence& images, std::int64_t stated) {
  if (stated == 0) return images.significant_bits();
  if (stated > static_cast<std::int64_t>(images.shape().bytes_per_pixel) * 8)
    throw Error(ExitCode::configuration, "replay.significant_bits = " + std::to_string(stated) + ", but " +
                                             images.file(0).string() + " has 8 bits per pixel; set it to 8 or less");
  return static_cast<std::uint32_t>(stated);
}

std::int64_t first_time_ns(const Timeline& timeline) {
  std::int64_t first = INT64_MAX;
  for (const auto& camera : timeline.shots)
    for (const Shot& shot : camera)
      if (shot.image != Shot::kNone) first = std::min(first, shot.time_ns);
  return first;
}

}  // namespace

ReplaySource::ReplaySource(const ReplaySettings& settings, const PreloadProgress& progress)
    : sequences_(open_cameras(settings.path, settings.pattern)) {
  Timeline timeline = make_timeline(settings.path, sequences_, settings.rate_hz, settings.first_index);
  if (timeline.period_ns <= 0 && settings.loop != 1)
    throw Error(ExitCode::configuration,
                settings.path + ": one image and no replay.rate_hz: state the rate at which it is to be repeated");
  for (const ImageSequence& images : sequences_)
    cameras_.push_back({images.camera(), images.shape(), bits_of(images, settings.significant_bits)});
  play_ = std::make_unique<Play>(std::move(timeline), settings.faults, settings.speed,
                                 static_cast<std::uint64_t>(settings.loop));
  if (settings.preload) decoded_ = preload(sequences_, settings.preload_limit_mb, progress);
  for (std::uint32_t camera = 0; camera < sequences_.size(); ++camera)
    players_.push_back(std::make_unique<CameraPlayer>(*play_, camera, sequences_[camera],
                                                      settings.preload ? &decoded_[camera] : nullptr));
}

ReplaySource::~ReplaySource() { stop(); }

void ReplaySource::start(FrameSink& sink) {
  play_->pacer.start(first_time_ns(play_->timeline), host_now_ns() + kLeadIn_ns);
  playing_.store(players_.size());
  for (std::size_t camera = 0; camera < players_.size(); ++camera) {
    threads_.emplace_back([this, &sink, &player = *players_[camera]] {
      player.run(sink);
      // acq_rel: the last one out ends the stream after everything that the others delivered.
      if (playing_.fetch_sub(1, std::memory_order_acq_rel) == 1 && !play_->pacer.stopped()) sink.end();
    });
    pthread_setname_np(threads_.back().native_handle(), ("rptv-play" + std::to_string(camera)).c_str());
  }
}

void ReplaySource::stop() noexcept {
  play_->pacer.stop();
  play_->gate.stop();
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
}

std::int64_t ReplaySource::worst_lateness_ns() const noexcept {
  std::int64_t worst = 0;
  for (const auto& player : players_) worst = std::max(worst, player->worst_lateness_ns());
  return worst;
}

}  // namespace rptv
