// SPDX-License-Identifier: MIT
// Watches, beside the tracking, whether the cameras of a rig still look where its calibration says.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "calibration/cameras/disparity_maps.hpp"
#include "calibration/cameras/rig.hpp"
#include "core/triple_buffer.hpp"
#include "core/wake.hpp"
#include "daemon/config.hpp"
#include "proto/status.hpp"
#include "reconstruct/multi_view/gather_disparities.hpp"
#include "reconstruct/multi_view/view_observer.hpp"
#include "reconstruct/reconstructor.hpp"

namespace rptv {

struct DriftOptions {
  double window_s = 60;                 ///< over which disparities are averaged
  double alarm_px = 0.5;                ///< largest disparity of a camera without a warning
  std::size_t most_detections = 16384;  ///< of a camera in a frame; one with more is passed over
  std::string rig_file;                 ///< for the warning
};

/// Every 32nd part of the window it copies the detections of one frame set; eight of them make a look
/// (gather_disparities, Wieneke 2008) on a thread of the lowest priority. Disparities are searched up to kSearched_px,
/// farther than the reconstruction's tolerance: there, a camera that has drifted takes part in no particle.
class DriftMonitor final : public ViewObserver {
 public:
  static constexpr double kSearched_px = 5;
  static constexpr std::size_t kFramesALook = 8, kLooksAWindow = 4;

  /// `rig`: three cameras or more; `rays`: theirs in the volume. Throws Error(usage) for a volume without content.
  DriftMonitor(Rig rig, std::vector<ViewRays> rays, const Volume& volume, const DriftOptions& options);
  /// Waits for the end of a look that is under way.
  ~DriftMonitor() override;
  DriftMonitor(const DriftMonitor&) = delete;
  DriftMonitor& operator=(const DriftMonitor&) = delete;

  /// Reconstructing thread. A copy when one is wanted, otherwise counted as passed over; never waits, never allocates.
  void see(std::span<const Detections> views) noexcept override;
  /// Reconstructing thread. Counts a frame set as passed over where it says no.
  bool wants() noexcept override;

  /// Adds what is known; a warning for each camera that was blind (blind_views) in more than half of the frame sets
  /// shown since the last call that had any; and a warning that names the camera with the largest disparity when that
  /// is beyond alarm_px. The others' are left out of it: triangulation spreads one camera's error over all. One thread.
  void tell(StatusReport& status);

 private:
  void run() noexcept;
  void take() noexcept;
  void look();
  std::string warning(const DriftReport& drift) const;
  void tell_blind(StatusReport& status);

  const Rig rig_;
  const std::vector<ViewRays> rays_;
  const DriftOptions options_;
  const DisparitySearch search_;
  DisparityMaps maps_;                       // the monitor's thread only
  std::vector<ParticleImages> frames_;       // the same
  ParticleImages sample_;                    // the reconstructing thread's while wanted_, the monitor's while not
  TripleBuffer<DriftReport> found_{{}};      // looked_at and cameras
  std::uint64_t looked_at_ = 0, taken_ = 0;  // the monitor's thread only
  bool warned_ = false;                      // tell()'s thread only
  std::uint32_t blind_ = 0;                  // the same: cameras that were when last told
  std::atomic<std::uint64_t> passed_over_{0};
  std::atomic<std::uint64_t> shown_{0};                         // since tell() asked
  std::array<std::atomic<std::uint64_t>, kMaxCameras> dark_{};  // of them, by camera
  std::atomic<bool> wanted_{true}, ending_{false};
  Wake wake_;
  std::thread thread_;
};

/// For a reconstruction from three views or more and multi_view.drift_alarm_px > 0; else null. It must outlive the
/// reconstruction's last frame. Throws Error.
std::unique_ptr<DriftMonitor> make_drift_monitor(const Config& config, const std::vector<CameraInfo>& cameras,
                                                 Reconstructor& reconstructor);

}  // namespace rptv
