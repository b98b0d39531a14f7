// SPDX-License-Identifier: MIT
// Receiving and counting behind daemon/live_listener.hpp.
#include "daemon/live_listener.hpp"

#include "core/clock.hpp"
#include "core/error.hpp"
#include "proto/encode.hpp"

namespace rptv {
LiveListener::LiveListener(const std::string& endpoint)
    : channel_({.endpoint = endpoint,
                .topics = {Topic::tracks, Topic::status},
                .curve_server_key = {},
                .high_water_mark = 10000}) {}

bool LiveListener::poll(int timeout_ms) {
  Topic topic{};
  std::span<const std::byte> body;
  if (!channel_.receive(topic, body, timeout_ms)) return false;
  const std::int64_t now_ns = host_now_ns();
  if (const std::string fault = decode(body, message_); !fault.empty())
    throw Error(ExitCode::bad_data, "live stream: " + fault + "; is an older or newer rapidptv publishing there?");
  if (const auto* status = std::get_if<StatusReport>(&message_.content)) status_ = *status;
  const auto* tracks = std::get_if<TracksColumns>(&message_.content);
  if (tracks == nullptr) return true;
  if (frames_ == 0) first_frame_ = message_.frame;
  last_frame_ = message_.frame;
  ++frames_;
  track_points_ += tracks->id.size();
  latency_.record(message_, now_ns);
  return true;
}

}  // namespace rptv
