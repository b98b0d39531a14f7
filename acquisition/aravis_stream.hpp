// SPDX-License-Identifier: MIT
// Buffers of the driver and slots of the sink: the buffer's memory is a leased slot; for the aravis_*.cpp files only.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "acquisition/aravis_chunks.hpp"
#include "acquisition/aravis_handle.hpp"
#include "acquisition/aravis_setup.hpp"
#include "acquisition/frame_counter.hpp"
#include "acquisition/source.hpp"

namespace rptv {

/// Outlives the streams of all sessions of a camera. A finished buffer's slot is delivered only when another slot could
/// be claimed to stand in for it; else the image is given up (the sink counts `pool_empty`) and its buffer used again.
/// So the driver always has the same number of buffers. Packed pixels come in buffers of the driver's own, are unpacked
/// into a slot by the receiving thread, and their buffer goes back at once.
class AravisStream {
 public:
  /// `slots`: of the sink's pool for this camera; `lent`: how many of them lie with the driver.
  AravisStream(std::uint32_t camera, const AravisSetup& setup, AravisChunks& chunks, std::size_t slots,
               std::size_t lent, std::int64_t priority);

  /// Claims what is not yet lent, gives all of it to `stream`. Before the acquisition starts. `period_ns`: between
  /// frames, by which those are estimated that were due since the last session; 0: unknown, none are.
  void begin(ArvStream* stream, FrameSink& sink, std::int64_t period_ns);
  /// What the camera's time stamps are from now on. Any thread.
  void set_clock(ClockId clock) noexcept { clock_.store(clock, std::memory_order_relaxed); }
  /// What breaks off from here on is our own doing, and no loss. Any thread.
  void leave() noexcept { leaving_.store(true, std::memory_order_relaxed); }
  /// Gives all slots back to the sink's pool, which may be gone before this object is. No stream may be left.
  void end() noexcept;
  /// Aravis' receiving thread begins.
  void enter() noexcept;
  /// The receiving thread sleeps, as it does when it has read all that came. Any thread.
  bool asleep() const;
  /// A buffer is done, well or not: Aravis' receiving thread.
  void done() noexcept;

  std::uint64_t delivered() const noexcept { return delivered_.load(std::memory_order_relaxed); }
  std::uint64_t unfit(std::size_t status) const noexcept { return unfit_[status].load(std::memory_order_relaxed); }
  static constexpr std::size_t kStatuses = 9;  ///< as in ArvBufferStatus; 0: complete but of another size
  static const char* status_name(std::size_t status) noexcept;
  Outage last_outage() const noexcept;
  std::int64_t outage_ns() const noexcept { return outage_ns_.load(std::memory_order_relaxed); }  ///< of all together
  bool priority_refused() const noexcept { return priority_refused_.load(std::memory_order_relaxed); }

 private:
  struct Slot {
    BufferHandle buffer;
    FrameLease lease;  ///< empty while downstream has it
  };
  Slot& hold(FrameLease lease) noexcept;
  FrameLease take_slot(const void* data) noexcept;
  void take(ArvStream* stream, ArvBuffer* buffer) noexcept;
  void refuse(ArvBuffer* buffer, std::size_t status) noexcept;
  void count_before_first(std::uint64_t id, std::int64_t now_ns) noexcept;
  void end_outage(ArvBuffer* first, std::int64_t now_ns) noexcept;
  void make_buffers();
  void lend_slots(ArvStream* stream);
  void lend_buffers(ArvStream* stream);

  const std::uint32_t camera_;
  const ImageShape shape_;
  const PixelFormat& format_;
  AravisChunks& chunks_;
  const std::size_t payload_bytes_;   ///< of a whole image with its chunks
  const std::size_t smallest_bytes_;  ///< of one with fewer chunks than it might have
  const std::size_t lent_;
  const std::int64_t priority_;
  const bool counts_from_one_;         ///< as GigE Vision does in each stream; USB3 Vision does not
  std::vector<Slot> slots_;            ///< by slot number of the pool
  bool buffers_made_ = false;          ///< of every slot
  std::vector<BufferHandle> buffers_;  ///< of packed pixels
  FrameCounter counter_;
  FrameSink* sink_ = nullptr;
  std::int64_t period_ns_ = 0;
  std::int64_t begun_ns_ = 0;
  std::int64_t last_frame_ns_ = 0;  // receiving thread, as the next two; 0: none yet
  std::uint64_t torn_since_ = 0;    // incomplete images since the last frame
  bool returns_ = false;            // no frame of this session yet, but of an earlier one
  std::atomic<int> thread_{0};      // receiving, as the kernel numbers it
  std::atomic<bool> leaving_{false};
  std::atomic<ClockId> clock_{ClockId::device};
  std::atomic<ArvStream*> stream_{nullptr};
  std::atomic<std::uint64_t> delivered_{0};
  std::array<std::atomic<std::uint64_t>, kStatuses> unfit_{};
  // The last outage; twice its number, odd while it is written, as there is one writer.
  std::atomic<std::uint64_t> outages_{0}, outage_frame_{0}, outage_due_{0};
  std::atomic<std::int64_t> last_outage_ns_{0};
  std::atomic<std::int64_t> outage_ns_{0};
  std::atomic<bool> priority_refused_{false};
};

}  // namespace rptv
