// SPDX-License-Identifier: MIT
// Small frames whose pixels say which frame they belong to, and the cameras that take them.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "acquisition/intake.hpp"

namespace rptv {

inline constexpr ImageShape kSmallShape{8, 2, 1};        // 16 bytes: room for one key twice
inline constexpr std::int64_t kLongNs = 20'000'000'000;  // a bound for what must come

inline std::vector<CameraInfo> small_cameras(std::size_t count) {
  std::vector<CameraInfo> cameras;
  for (std::size_t i = 0; i < count; ++i) cameras.push_back({"camera" + std::to_string(i), kSmallShape, 8});
  return cameras;
}

inline std::uint64_t key_of(const FrameInfo& info) { return info.index * kMaxCameras + info.camera + 1; }

/// A frame in the given slot, its key in every pixel of it.
inline Frame made_frame(FrameLease lease, std::uint32_t camera, std::uint64_t index, bool torn = false) {
  Frame frame{{}, kSmallShape, std::move(lease)};
  frame.info.index = index;
  frame.info.camera = camera;
  frame.info.exposure_end_host_ns = static_cast<std::int64_t>(index) * 1'000'000;
  frame.info.torn = torn;
  const std::uint64_t keys[2] = {key_of(frame.info), key_of(frame.info)};
  if (frame.lease) std::memcpy(frame.lease.get(), keys, sizeof keys);
  return frame;
}

/// The pixels are the ones that the frame was delivered with: nobody else has written to its slot.
inline bool is_intact(const Frame& frame) {
  std::uint64_t keys[2] = {0, 0};
  if (frame.lease) std::memcpy(keys, frame.lease.get(), sizeof keys);
  return keys[0] == key_of(frame.info) && keys[1] == keys[0];
}

/// Claims a slot, fills it and delivers it; false when there was no slot.
inline bool send(FrameSink& sink, std::uint32_t camera, std::uint64_t index, bool torn = false) {
  FrameLease lease = sink.claim(camera);
  if (!lease) return false;
  sink.deliver(made_frame(std::move(lease), camera, index, torn));
  return true;
}

/// One frame of each camera, all of one index, all intact.
inline bool is_whole(const FrameSet& set, std::size_t cameras) {
  if (set.cameras != cameras) return false;
  for (std::uint32_t i = 0; i < set.cameras; ++i) {
    const Frame& frame = set.frames[i];
    if (frame.info.camera != i || frame.info.index != set.info().index || frame.info.torn || !is_intact(frame))
      return false;
  }
  return true;
}

/// What became of frames that were delivered and are in no set. Gaps and failed claims are about frames that were not.
inline std::uint64_t lost_after_delivery(const Losses& losses) {
  return losses.total() - losses.of(LossCause::source_gap) - losses.of(LossCause::pool_empty);
}

}  // namespace rptv
