// SPDX-License-Identifier: MIT
// What a camera's supervising thread works on; private to AravisCamera, for the aravis_*.cpp files only.
#pragma once

#include <atomic>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "acquisition/aravis_camera.hpp"
#include "acquisition/aravis_chunks.hpp"
#include "acquisition/aravis_ptp.hpp"
#include "acquisition/aravis_setup.hpp"
#include "acquisition/aravis_stream.hpp"
#include "acquisition/aravis_trigger.hpp"
#include "acquisition/gvcp_probe.hpp"
#include "core/wake.hpp"

namespace rptv {

/// The supervising thread's own, except what is atomic or said to be guarded.
struct AravisCamera::Life {
  /// Opens and sets up the camera. Throws Error.
  Life(const AravisSettings& settings, const std::string& name, std::uint32_t number, std::size_t pool_frames);

  /// Until stop: opens what was lost, starts it, looks after it.
  void supervise(FrameSink& sink) noexcept;
  void open_again();
  void look_for_it();
  bool answers() const;
  void begin_session(FrameSink& sink);
  void end_session() noexcept;
  /// Until all that the camera sent before it was lost is read, at most half a second.
  void let_it_read() const;
  /// Until control is lost, or stop. Fires the software trigger.
  void look_after_it();
  bool has_control() const;
  /// False when stop was asked for; returns early then, and when `lost`.
  bool wait(std::int64_t timeout_ns) noexcept;
  void tell(DeviceState state, std::string problem);
  void show_ptp(const PtpState& now);

  const AravisSettings settings;
  const std::string name;
  CameraHandle camera;
  AravisSetup setup;
  GvcpIdentity identity;         ///< known for GigE Vision cameras
  std::uint64_t unanswered = 0;  ///< tries since it last answered
  SoftwareTrigger trigger;
  AravisChunks chunks;
  AravisStream buffers;
  std::atomic<bool> lost{false}, stopping{false};
  Wake wake;
  std::thread thread;

  mutable std::mutex mutex;  ///< guards what follows; no receiving thread takes it
  StreamHandle stream;       ///< the thread itself reads it unguarded
  DeviceStatus status;
  std::string ptp;                  ///< of the camera's clock, as it was last seen
  std::vector<DeviceCounter> past;  ///< what the streams of earlier sessions counted
};

}  // namespace rptv
