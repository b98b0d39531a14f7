// SPDX-License-Identifier: MIT
// Any bytes from the network: decoding either gives a reason or a message that can be printed in every form.
#include <google/protobuf/stubs/logging.h>

#include "proto/encode.hpp"
#include "proto/text.hpp"

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  google::protobuf::SetLogHandler(nullptr);  // its complaints about UTF-8 would drown the findings
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  rptv::WireMessage message;
  if (!rptv::decode(std::as_bytes(std::span(data, size)), message).empty()) return 0;
  rptv::ReceivedLatency latency;
  latency.record(message, 1);
  rptv::SequenceCheck sequence;
  sequence.missing_before(rptv::Topic::tracks, message);
  const bool printed = !rptv::to_json(message, 1).empty() && !latency.json().empty();
  if (rptv::to_line(message, 1).empty() || !printed) __builtin_trap();
  return 0;
}
