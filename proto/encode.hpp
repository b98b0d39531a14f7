// SPDX-License-Identifier: MIT
// Results and status to the bytes of rapidptv.proto, and back.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "core/result.hpp"
#include "proto/wire.hpp"

namespace rptv {

/// Keeps one protobuf message per topic and one byte buffer. Tracks and particles: after construction neither this
/// class nor protobuf allocates (bytes fields are reserved for the capacities, scalars are overwritten in place, and
/// serialisation goes into the buffer). Status and rig allocate; they are not per-frame. One thread at a time.
/// Each call returns a view that is valid until the next call, and counts the topic's `sequence` up.
class Encoder {
 public:
  /// `session`: random text that names this run of the daemon. Throws Error(internal) when a full message of these
  /// capacities would exceed protobuf's 2 GiB.
  Encoder(std::string_view session, std::size_t particle_capacity, std::size_t track_capacity);
  ~Encoder();
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;

  /// Stage::published of `stamps` is set here, once the message is filled.
  std::span<const std::byte> tracks(const Result& result, Stamps& stamps) noexcept;
  std::span<const std::byte> particles(const Result& result, Stamps& stamps) noexcept;
  std::span<const std::byte> status(const StatusReport& report);
  std::span<const std::byte> rig(std::string_view calibration, std::string_view config);

 private:
  struct Messages;
  std::unique_ptr<Messages> messages_;
};

/// Reads one message's second part. Returns an empty text, or one line that says what is wrong with it (then `message`
/// is unspecified). Checks the schema, that all columns have one length, that stamps are not negative and that exactly
/// one content is there; numbers may be NaN. Any thread; allocates.
std::string decode(std::span<const std::byte> bytes, WireMessage& message);

/// 128 random bits as hex digits.
std::string make_session_name();
/// The kernel's boot id: two processes with the same one read the same CLOCK_MONOTONIC. Empty when it cannot be read.
std::string read_boot_id();

}  // namespace rptv
