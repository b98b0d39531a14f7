// SPDX-License-Identifier: MIT
// A small rig that is in order, and the ways in which users' rigs are not.
#pragma once

#include <filesystem>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "core/image.hpp"

namespace rptv::testing {

/// A folder with five 16-bit frames, a calibration that fits them and a configuration; removed by the destructor.
/// Every user of the machine may use it.
class Rig {
 public:
  Rig();
  ~Rig();
  Rig(const Rig&) = delete;
  Rig& operator=(const Rig&) = delete;

  std::filesystem::path config() const { return folder / "rig.toml"; }
  std::filesystem::path calibration() const { return folder / "calibration.toml"; }
  std::filesystem::path frame(int index) const;
  /// Grey values that no frame has by accident.
  void write_frame(int index, ImageShape shape) const;
  /// Replaces the first `what` in the file by `with`; aborts when it is not there.
  void replace(const std::filesystem::path& file, const std::string& what, const std::string& with) const;
  /// A port of 127.0.0.1 on which this object listens as long as it lives.
  std::string taken_port();

  std::filesystem::path folder;

 private:
  int listener_ = -1;
};

/// One mistake, and what the user must be told about it.
struct BadInput {
  std::string name;
  std::function<void(Rig&)> spoil;
  ExitCode code;
  std::vector<std::string> words;  ///< all of them in the one line: the file, the value, the next step
  bool needs_other_user = false;   ///< nothing is forbidden to root
};
inline void PrintTo(const BadInput& bad, std::ostream* out) { *out << bad.name; }
std::vector<BadInput> bad_inputs();

}  // namespace rptv::testing
