// SPDX-License-Identifier: MIT
// The linker's memory as bytes and back, for a daemon that restarts within a recording.
#include <array>
#include <cstring>
#include <string>
#include <type_traits>

#include "core/error.hpp"
#include "tracking/linker_work.hpp"

namespace rptv {

namespace {

constexpr std::array<char, 8> kMagic{'r', 'p', 't', 'v', 'l', 'n', 'k', '1'};

class Bytes {
 public:
  template <class T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto from = std::as_bytes(std::span(&value, 1));
    bytes.insert(bytes.end(), from.begin(), from.end());
  }
  std::vector<std::byte> bytes;
};

class ReadBytes {
 public:
  explicit ReadBytes(std::span<const std::byte> from) : left_(from) {}
  template <class T>
  void get(T& value) {
    if (left_.size() < sizeof value) refuse("is cut off");
    std::memcpy(&value, left_.data(), sizeof value);
    left_ = left_.subspan(sizeof value);
  }
  bool ended() const noexcept { return left_.empty(); }
  [[noreturn]] static void refuse(const std::string& what) {
    throw Error(ExitCode::bad_data, "the linker's snapshot " + what + "; start without it");
  }

 private:
  std::span<const std::byte> left_;
};

/// Everything that must be equal for tracks to go on; capacities may grow.
std::uint64_t fingerprint(LinkerSettings settings) {
  settings.max_particles = settings.max_tracks = 1;
  FieldList list;
  settings.fields(list);
  std::uint64_t h = 0xcbf29ce484222325ULL;
  for (const char c : to_toml(list, 1)) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return h;
}

}  // namespace

std::vector<std::byte> Linker::snapshot() const {
  const Work& w = *work_;
  Bytes out;
  out.put(kMagic);
  out.put(fingerprint(w.settings));
  out.put(w.clock);
  out.put(w.now);
  out.put(w.exposure_ns);
  out.put(w.counters);
  out.put(w.next_id);
  out.put(w.last_seen);
  out.put(static_cast<std::uint64_t>(w.seen_count));
  out.put(static_cast<std::uint64_t>(w.live));
  for (std::size_t s = 0; s < w.live; ++s) {
    out.put(w.tracks[s]);
    if (s >= w.seen_count) out.put(w.unseen[s - w.seen_count]);
    if (w.motion.filters()) out.put(w.motion.filter(w.tracks[s]));
  }
  if (const FlowField* flow = w.motion.flow(); flow != nullptr)
    for (const FlowField::Bin& bin : flow->bins()) out.put(bin);
  return out.bytes;
}

void Linker::restore(std::span<const std::byte> snapshot) {
  Work fresh(work_->settings);
  ReadBytes in(snapshot);
  std::array<char, 8> magic{};
  std::uint64_t settings = 0, seen_count = 0, live = 0;
  in.get(magic);
  if (magic != kMagic) ReadBytes::refuse("is not one, or of another version");
  in.get(settings);
  if (settings != fingerprint(fresh.settings)) ReadBytes::refuse("was made with other settings");
  in.get(fresh.clock);
  in.get(fresh.now);
  in.get(fresh.exposure_ns);
  in.get(fresh.counters);
  in.get(fresh.next_id);
  in.get(fresh.last_seen);
  in.get(seen_count);
  in.get(live);
  if (live > fresh.max_tracks || seen_count > live || seen_count > fresh.max_particles)
    ReadBytes::refuse("holds more tracks than there is room for");
  fresh.live = live;
  fresh.seen_count = seen_count;
  for (std::size_t s = 0; s < live; ++s) {
    in.get(fresh.tracks[s]);
    if (s >= seen_count) in.get(fresh.unseen[s - seen_count]);
    if (!fresh.motion.filters()) continue;
    fresh.motion.take_slot(fresh.tracks[s]);
    in.get(fresh.motion.filter(fresh.tracks[s]));
  }
  if (FlowField* flow = fresh.motion.flow(); flow != nullptr) {
    std::vector<FlowField::Bin> bins(flow->bins().size());
    for (FlowField::Bin& bin : bins) in.get(bin);
    flow->restore(bins);
  }
  if (!in.ended()) ReadBytes::refuse("has bytes to spare");
  fresh.motion.begin_frame(fresh.now, fresh.clock.period_ns());  // for predict() before the next frame
  *work_ = std::move(fresh);
}

}  // namespace rptv
