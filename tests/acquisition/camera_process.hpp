// SPDX-License-Identifier: MIT
// A test camera in a process of its own, and what it did.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <optional>
#include <string>

#include "core/descriptor.hpp"
#include "tests/acquisition/shared_truth.hpp"
#include "tests/proto/place.hpp"

namespace rptv {

/// One life of a camera. Environment variable GVSP_CAMERA names the binary. Main thread.
class CameraProcess {
 public:
  /// Image numbers are `session` · 2³² + 1, + 2, …: a stale image betrays itself. Returns when it listens. Throws
  /// std::runtime_error when it does not start.
  CameraProcess(const std::string& address, std::uint64_t session, const std::string& serial = "SIM1");
  ~CameraProcess() { end(9); }
  CameraProcess(const CameraProcess&) = delete;
  CameraProcess& operator=(const CameraProcess&) = delete;

  void kill() { end(9); }  ///< in the middle of whatever it does
  void rest();             ///< sends the image under way to its end, and from then on only answers
  void freeze();           ///< neither answers nor sends …
  void thaw();             ///< … until here, where it goes on as it was
  const GvspTruth& truth() const { return *truth_; }
  static std::uint64_t session_of(std::uint64_t sequence) { return sequence >> 32; }

 private:
  void end(int signal);
  bool hears_word() const;

  const Place place_;
  const SharedTruth truth_;
  pid_t pid_ = -1;
  std::optional<Descriptor> said_;
};

}  // namespace rptv
