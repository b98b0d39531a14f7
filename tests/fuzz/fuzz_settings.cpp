// SPDX-License-Identifier: MIT
// Any bytes as a configuration, a calibration and a lens prescription: read or refused in one line, and what was read
// is written back.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include "calibration/light_field/light_field_calibration.hpp"
#include "core/error.hpp"
#include "daemon/config.hpp"
#include "simulation/lens_analysis.hpp"
#include "simulation/prescription.hpp"

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

/// Runs `read`; true when it took the text, false when it refused it with one line.
template <class Read>
bool taken(Read read) {
  try {
    read();
    return true;
  } catch (const rptv::Error& error) {
    require(std::strchr(error.what(), '\n') == nullptr && std::strncmp(error.what(), "rig.toml", 8) == 0);
    return false;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  rptv::Config config;
  if (taken([&] { config = rptv::parse_config(text, "rig.toml"); })) {
    const std::string printed = to_toml(config);
    require(taken([&] { config = rptv::parse_config(printed, "rig.toml"); }));
    require(to_toml(config) == printed);
    require(to_json(config).size() > 2);
  }
  taken([&] { rptv::parse_light_field_calibration(text, "rig.toml"); });
  taken([&] { require(describe_lens(rptv::parse_prescription(text, "rig.toml"), 0, 0).size() > 2); });
  return 0;
}
