// SPDX-License-Identifier: MIT
// What happens in Aravis' receiving thread when an image is complete, or is not.
#include "acquisition/aravis_stream.hpp"

#include <arv.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <string>

#include "core/clock.hpp"

namespace rptv {
namespace {

// Of a buffer that Aravis has not filled since it got it: no camera counts so far.
constexpr std::uint64_t kUnfilled = ~std::uint64_t{0};

constexpr std::int64_t kUnsteady_ns = 100'000'000;  // by so much images may come closer together than they should

// With the reference that the caller has.
void lend(ArvStream* stream, ArvBuffer* buffer) noexcept {
  arv_buffer_set_frame_id(buffer, kUnfilled);
  arv_stream_push_buffer(stream, buffer);
}

ArvBuffer* another_reference(const BufferHandle& buffer) noexcept { return ARV_BUFFER(g_object_ref(buffer.get())); }

}  // namespace

AravisStream::AravisStream(std::uint32_t camera, const AravisSetup& setup, AravisChunks& chunks, std::size_t slots,
                           std::size_t lent, std::int64_t priority)
    : camera_(camera),
      shape_(setup.shape),
      format_(*setup.format),
      chunks_(chunks),
      payload_bytes_(setup.payload_bytes),
      smallest_bytes_(setup.payload_bytes - setup.bytes_behind_image),
      lent_(lent),
      priority_(priority),
      counts_from_one_(!setup.wide_ids),
      slots_(slots),
      counter_(setup.wide_ids ? FrameCounter::Width::bits64 : FrameCounter::Width::bits16) {}

const char* AravisStream::status_name(std::size_t status) noexcept {
  static constexpr std::array<const char*, kStatuses> kNames{
      "size",    "cleared", "timeout", "missing_packets", "wrong_packet_id", "size_mismatch",
      "filling", "aborted", "other"};
  return kNames[status];
}

// Before the first frame, when every slot is free: afterwards nothing of ours allocates.
void AravisStream::make_buffers() {
  std::vector<FrameLease> all;
  while (all.size() < slots_.size() && all.emplace_back(sink_->claim(camera_))) {
    Slot& slot = slots_.at(all.back().slot());
    slot.buffer.reset(arv_buffer_new(payload_bytes_, all.back().get()));
  }
  buffers_made_ = true;
}

AravisStream::Slot& AravisStream::hold(FrameLease lease) noexcept {
  Slot& slot = slots_[lease.slot()];
  slot.lease = std::move(lease);
  return slot;
}

void AravisStream::begin(ArvStream* stream, FrameSink& sink, std::int64_t period_ns) {
  sink_ = &sink;
  stream_.store(stream);
  period_ns_ = period_ns;
  begun_ns_ = host_now_ns();
  returns_ = last_frame_ns_ != 0;
  format_.unpack == nullptr ? lend_slots(stream) : lend_buffers(stream);
}

void AravisStream::lend_buffers(ArvStream* stream) {
  while (buffers_.size() < lent_) buffers_.emplace_back(arv_buffer_new_allocate(payload_bytes_));
  for (const BufferHandle& buffer : buffers_) lend(stream, another_reference(buffer));
}

void AravisStream::lend_slots(ArvStream* stream) {
  if (!buffers_made_) make_buffers();
  const auto holds = [](const Slot& slot) { return static_cast<bool>(slot.lease); };
  auto held = static_cast<std::size_t>(std::count_if(slots_.begin(), slots_.end(), holds));
  for (; held < lent_; ++held) {
    FrameLease lease = sink_->claim(camera_);
    if (!lease) break;
    hold(std::move(lease));
  }
  for (Slot& slot : slots_)
    if (slot.lease) lend(stream, another_reference(slot.buffer));
}

void AravisStream::end() noexcept {
  for (Slot& slot : slots_) {
    slot.buffer.reset();  // it points into the pool
    slot.lease.reset();
  }
  buffers_.clear();
  buffers_made_ = false;
}

FrameLease AravisStream::take_slot(const void* data) noexcept {
  const auto slot = std::find_if(slots_.begin(), slots_.end(), [&](const Slot& s) {
    return s.lease && static_cast<const void*>(s.lease.get()) == data;
  });
  return std::move(slot->lease);
}

void AravisStream::enter() noexcept {
  thread_.store(gettid());
  if (priority_ > 0 && !arv_make_thread_realtime(static_cast<int>(priority_))) priority_refused_.store(true);
}

// "number (name) state …"
bool AravisStream::asleep() const {
  std::ifstream file("/proc/self/task/" + std::to_string(thread_.load()) + "/stat");
  std::string text;
  std::getline(file, text);
  const auto name_end = text.rfind(") ");
  return name_end == std::string::npos || text.compare(name_end, 3, ") S") == 0;
}

// Aravis may put a buffer into the queue without telling, so: all that are there, not one for each call.
void AravisStream::done() noexcept {
  ArvStream* stream = stream_.load();
  while (ArvBuffer* buffer = arv_stream_try_pop_buffer(stream)) take(stream, buffer);  // with the queue's reference
}

// For a packet that belongs to no image Aravis takes a buffer and gives it back as it was, old image and all.
void AravisStream::refuse(ArvBuffer* buffer, std::size_t status) noexcept {
  unfit_[std::min(status, kStatuses - 1)].fetch_add(1, std::memory_order_relaxed);
  const bool ours = status == ARV_BUFFER_STATUS_ABORTED && leaving_.load(std::memory_order_relaxed);
  if (status != ARV_BUFFER_STATUS_CLEARED && !ours) {
    ++torn_since_;
    sink_->lose(camera_, LossCause::source_torn, 1);
  }
  lend(stream_.load(), buffer);
}

// The id of the first image tells what went before it, unless the camera counts on from an earlier stream: then it
// tells of more than fitted into the time.
void AravisStream::count_before_first(std::uint64_t id, std::int64_t now_ns) noexcept {
  if (!counts_from_one_ || period_ns_ <= 0 || id <= 1 + torn_since_) return;
  const auto fit = static_cast<std::uint64_t>((now_ns - begun_ns_ + kUnsteady_ns) / period_ns_) + 1;
  if (id - 1 <= fit) sink_->lose(camera_, LossCause::source_gap, id - 1 - torn_since_);
}

// The camera counts anew. What it took while it was gone, if anything, nobody knows: what the clock says was due.
void AravisStream::end_outage(ArvBuffer* first, std::int64_t now_ns) noexcept {
  const std::int64_t away_ns = now_ns - last_frame_ns_;
  const std::int64_t due = period_ns_ > 0 ? (away_ns + period_ns_ / 2) / period_ns_ - 1 : 0;
  const std::uint64_t missed = std::max<std::int64_t>(due - static_cast<std::int64_t>(torn_since_), 0);
  counter_.reopen(torn_since_ + missed);
  if (missed > 0) sink_->lose(camera_, LossCause::source_outage, missed);
  outage_ns_.fetch_add(away_ns, std::memory_order_relaxed);
  outages_.fetch_add(1);  // odd: the event is being written
  outage_frame_.store(counter_.index_of(arv_buffer_get_frame_id(first)));
  outage_due_.store(missed);
  last_outage_ns_.store(away_ns);
  outages_.fetch_add(1);
  returns_ = false;
}

Outage AravisStream::last_outage() const noexcept {
  for (;;) {
    const std::uint64_t before = outages_.load();
    const Outage last{before / 2, outage_frame_.load(), last_outage_ns_.load(), outage_due_.load()};
    if (before % 2 == 0 && outages_.load() == before) return last;
  }
}

void AravisStream::take(ArvStream* stream, ArvBuffer* buffer) noexcept {
  const std::int64_t now_ns = host_now_ns();
  const auto status = static_cast<std::size_t>(arv_buffer_get_status(buffer));
  std::size_t bytes = 0;
  const void* data = arv_buffer_get_data(buffer, &bytes);
  if (status == ARV_BUFFER_STATUS_SUCCESS && arv_buffer_get_frame_id(buffer) == kUnfilled)
    return refuse(buffer, ARV_BUFFER_STATUS_CLEARED);
  if (status != ARV_BUFFER_STATUS_SUCCESS || bytes < smallest_bytes_ || bytes > payload_bytes_)
    return refuse(buffer, status);
  if (returns_) end_outage(buffer, now_ns);
  if (!counter_.started()) count_before_first(arv_buffer_get_frame_id(buffer), now_ns);
  last_frame_ns_ = now_ns;
  torn_since_ = 0;
  Frame frame;
  frame.info.index = counter_.index_of(arv_buffer_get_frame_id(buffer));
  if (chunks_.asked()) chunks_.read(buffer, frame.info.index);
  FrameLease other = sink_->claim(camera_);
  if (!other) return lend(stream, buffer);
  frame.info.camera = camera_;
  frame.info.clock = clock_.load(std::memory_order_relaxed);
  frame.info.exposure_end_ns = static_cast<std::int64_t>(arv_buffer_get_timestamp(buffer));
  frame.info.exposure_end_host_ns = now_ns;
  frame.info.arrival_ns = now_ns;
  frame.shape = shape_;
  if (format_.unpack != nullptr) {
    format_.unpack(static_cast<const std::byte*>(data), reinterpret_cast<std::uint16_t*>(other.get()),
                   std::size_t{shape_.width_px} * shape_.height_px, best_instruction_set());
    frame.lease = std::move(other);
    lend(stream, buffer);
  } else {
    frame.lease = take_slot(data);
    g_object_unref(buffer);  // its Slot keeps it for the time when the memory comes back
    lend(stream, another_reference(hold(std::move(other)).buffer));
  }
  delivered_.fetch_add(1, std::memory_order_relaxed);
  sink_->deliver(std::move(frame));
}

}  // namespace rptv
