// SPDX-License-Identifier: MIT
// The writer's thread.
#include "daemon/result_writer.hpp"

#include <pthread.h>

namespace rptv {

ResultWriter::ResultWriter(const std::string& tracks_file, const std::string& points_file, HandOverPolicy policy,
                           Losses& losses, TrackColumns columns)
    : queue_(policy, losses, LossCause::writer_backlog) {
  if (!tracks_file.empty()) tracks_ = std::make_unique<TracksWriter>(tracks_file, columns);
  if (!points_file.empty())
    points_ =
        std::make_unique<PointsWriter>(points_file, PointColumns{.covariance = true, .ghost = true, .time = true});
  thread_ = std::thread([this] { loop(); });
  pthread_setname_np(thread_.native_handle(), "rptv-write");
}

ResultWriter::~ResultWriter() {
  queue_.close();
  if (thread_.joinable()) thread_.join();
}

void ResultWriter::loop() noexcept {
  constexpr std::int64_t kPatienceNs = 100'000'000;
  ResultLease result;
  for (Taken taken; (taken = queue_.pop(result, kPatienceNs)) != Taken::closed;) {
    if (taken == Taken::timeout) continue;
    const double t_s = static_cast<double>(result->exposure_end_ns) * 1e-9;
    if (tracks_) tracks_->write(result->frame, t_s, result->tracks);
    if (points_) points_->write(result->frame, t_s, result->particles);
    result.reset();
  }
}

void ResultWriter::finish() {
  queue_.close();
  if (thread_.joinable()) thread_.join();
  if (tracks_) tracks_->close();
  if (points_) points_->close();
}

}  // namespace rptv
