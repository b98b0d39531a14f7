// SPDX-License-Identifier: MIT
// Which source and which reconstruction a configuration asks for.
#include "daemon/session.hpp"
#include "reconstruct/light_field.hpp"
#include "replay/replay_source.hpp"

namespace rptv {

std::unique_ptr<Source> make_source(const Config& config) { return std::make_unique<ReplaySource>(config.replay); }

std::unique_ptr<Reconstructor> make_reconstructor(const Config& config, const std::vector<CameraInfo>& cameras) {
  if (cameras.size() != 1)
    throw Error(ExitCode::configuration, "a light field has one camera and the source has " +
                                             std::to_string(cameras.size()) + "; give one camera's folder as its path");
  return std::make_unique<LightField>(config.light_field, cameras.front());
}

}  // namespace rptv
