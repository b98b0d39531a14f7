// SPDX-License-Identifier: MIT
// What happens in Aravis' receiving thread when an image is complete, or is not.
#include "acquisition/aravis_stream.hpp"

#include <arv.h>

#include <algorithm>

#include "core/clock.hpp"

namespace rptv {

AravisStream::AravisStream(std::uint32_t camera, ImageShape shape, const PixelFormat& format, std::size_t slots,
                           std::size_t lent, std::int64_t priority, FrameCounter::Width width)
    : camera_(camera),
      shape_(shape),
      format_(format),
      payload_bytes_(format.payload_bytes(std::size_t{shape.width_px} * shape.height_px)),
      lent_(lent),
      priority_(priority),
      slots_(slots),
      counter_(width) {}

const char* AravisStream::status_name(std::size_t status) noexcept {
  static constexpr std::array<const char*, kStatuses> kNames{
      "size",    "cleared", "timeout", "missing_packets", "wrong_packet_id", "size_mismatch",
      "filling", "aborted", "other"};
  return kNames[status];
}

// Allocates the first time that a slot comes by, at most once per slot.
AravisStream::Slot* AravisStream::hold(FrameLease lease) {
  if (lease.slot() >= slots_.size()) slots_.resize(lease.slot() + 1);
  Slot& slot = slots_[lease.slot()];
  if (!slot.buffer) slot.buffer.reset(arv_buffer_new(shape_.bytes(), lease.get()));
  slot.lease = std::move(lease);
  return &slot;
}

void AravisStream::begin(ArvStream* stream, FrameSink& sink, std::uint64_t missed) {
  sink_ = &sink;
  stream_.store(stream);
  counter_.reopen(missed);
  format_.unpack == nullptr ? lend_slots(stream) : lend_buffers(stream);
}

void AravisStream::lend_buffers(ArvStream* stream) {
  while (buffers_.size() < lent_) buffers_.emplace_back(arv_buffer_new_allocate(payload_bytes_));
  for (const BufferHandle& buffer : buffers_) arv_stream_push_buffer(stream, ARV_BUFFER(g_object_ref(buffer.get())));
}

void AravisStream::lend_slots(ArvStream* stream) {
  const auto holds = [](const Slot& slot) { return static_cast<bool>(slot.lease); };
  auto held = static_cast<std::size_t>(std::count_if(slots_.begin(), slots_.end(), holds));
  for (; held < lent_; ++held) {
    FrameLease lease = sink_->claim(camera_);
    if (!lease) break;
    hold(std::move(lease));
  }
  for (Slot& slot : slots_)
    if (slot.lease) arv_stream_push_buffer(stream, ARV_BUFFER(g_object_ref(slot.buffer.get())));
}

void AravisStream::end() noexcept {
  for (Slot& slot : slots_) {
    slot.buffer.reset();  // it points into the pool
    slot.lease.reset();
  }
  buffers_.clear();
}

FrameLease AravisStream::take_slot(const void* data) noexcept {
  const auto slot = std::find_if(slots_.begin(), slots_.end(), [&](const Slot& s) {
    return s.lease && static_cast<const void*>(s.lease.get()) == data;
  });
  return std::move(slot->lease);
}

void AravisStream::enter() noexcept {
  if (priority_ > 0 && !arv_make_thread_realtime(static_cast<int>(priority_))) priority_refused_.store(true);
}

void AravisStream::done() noexcept {
  ArvStream* stream = stream_.load();
  ArvBuffer* buffer = arv_stream_try_pop_buffer(stream);  // the one just finished, with the queue's reference
  if (buffer == nullptr) return;
  const std::int64_t now_ns = host_now_ns();
  const auto status = static_cast<std::size_t>(arv_buffer_get_status(buffer));
  std::size_t bytes = 0;
  const void* data = arv_buffer_get_data(buffer, &bytes);
  const bool whole = status == ARV_BUFFER_STATUS_SUCCESS && bytes == payload_bytes_;
  if (!whole) {
    unfit_[std::min(status, kStatuses - 1)].fetch_add(1, std::memory_order_relaxed);
    if (status != ARV_BUFFER_STATUS_ABORTED) sink_->lose(camera_, LossCause::source_torn, 1);
    arv_stream_push_buffer(stream, buffer);
    return;
  }
  last_frame_ns_.store(now_ns, std::memory_order_relaxed);
  Frame frame;
  frame.info.index = counter_.index_of(arv_buffer_get_frame_id(buffer));
  FrameLease other = sink_->claim(camera_);
  if (!other) {
    arv_stream_push_buffer(stream, buffer);
    return;
  }
  frame.info.camera = camera_;
  frame.info.clock = ClockId::device;
  frame.info.exposure_end_ns = static_cast<std::int64_t>(arv_buffer_get_timestamp(buffer));
  frame.info.exposure_end_host_ns = now_ns;
  frame.info.arrival_ns = now_ns;
  frame.shape = shape_;
  if (format_.unpack != nullptr) {
    format_.unpack(static_cast<const std::byte*>(data), reinterpret_cast<std::uint16_t*>(other.get()),
                   std::size_t{shape_.width_px} * shape_.height_px, best_instruction_set());
    frame.lease = std::move(other);
    arv_stream_push_buffer(stream, buffer);
  } else {
    frame.lease = take_slot(data);
    g_object_unref(buffer);  // its Slot keeps it for the time when the memory comes back
    arv_stream_push_buffer(stream, ARV_BUFFER(g_object_ref(hold(std::move(other))->buffer.get())));
  }
  delivered_.fetch_add(1, std::memory_order_relaxed);
  sink_->deliver(std::move(frame));
}

}  // namespace rptv
