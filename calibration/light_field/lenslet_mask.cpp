// SPDX-License-Identifier: MIT
// Names of the reasons why a lenslet is left out.
#include "calibration/light_field/lenslet_mask.hpp"

#include <utility>

namespace rptv {

std::string reasons_text(std::uint8_t reasons) {
  using namespace lenslet_reason;
  std::string text;
  for (const auto& [bit, name] : {std::pair{kArea, "area"},
                                  {kEccentricity, "eccentricity"},
                                  {kResidual, "residual"},
                                  {kBrightness, "brightness"},
                                  {kBorder, "border"}})
    if ((reasons & bit) != 0) text += (text.empty() ? "" : ", ") + std::string(name);
  return text.empty() ? "none" : text;
}

}  // namespace rptv
