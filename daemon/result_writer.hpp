// SPDX-License-Identifier: MIT
// Writes tracks and points to CSV files on a thread of its own, so that a slow disk never holds up the tracking.
#pragma once

#include <memory>
#include <string>
#include <thread>

#include "core/hand_over.hpp"
#include "core/result.hpp"
#include "core/tables.hpp"

namespace rptv {

/// Construction opens the files and throws Error when it cannot. write(): one producer thread, never throws.
class ResultWriter {
 public:
  /// An empty path: that table is not written; "-" is standard output. `policy`: Lossless makes the producer wait for
  /// the disk, Bounded loses rows, counted in `losses` as writer_backlog. `losses` must outlive the writer.
  ResultWriter(const std::string& tracks_file, const std::string& points_file, HandOverPolicy policy, Losses& losses,
               TrackColumns columns = {});
  ~ResultWriter();

  void write(ResultLease&& result) noexcept { queue_.push(std::move(result)); }
  /// Writes what waits, closes the files, and throws Error(io) when anything of it could not be written.
  void finish();

 private:
  void loop() noexcept;

  HandOver<ResultLease> queue_;
  std::unique_ptr<TracksWriter> tracks_;
  std::unique_ptr<PointsWriter> points_;
  std::thread thread_;
};

}  // namespace rptv
