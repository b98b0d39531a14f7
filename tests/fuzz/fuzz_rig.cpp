// SPDX-License-Identifier: MIT
// Any bytes as a rig and as OpenPTV's files: read or refused in one line; what was read is written back, and its
// cameras take any pixel and point.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

#include "calibration/cameras/openptv.hpp"
#include "calibration/cameras/rig.hpp"
#include "core/error.hpp"
#include "simulation/lpt_points.hpp"

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

template <class Read>
auto taken(Read read) -> std::optional<decltype(read())> {
  try {
    return read();
  } catch (const rptv::Error& error) {
    require(std::strchr(error.what(), '\n') == nullptr && std::strncmp(error.what(), "file", 4) == 0);
    return {};
  }
}

/// Whatever the numbers are, projection and ray end, and agree where both have an answer.
void look_through(const rptv::CameraModel& model) {
  const rptv::SightRay ray = model.ray({0, 0});
  require(!ray.valid() || std::abs(std::hypot(ray.direction[0], ray.direction[1], ray.direction[2]) - 1) < 1e-6);
  rptv::PixelJacobian jacobian;
  const auto plain = model.project({1, 2, 3}), derived = model.project({1, 2, 3}, jacobian);
  require(plain.has_value() == derived.has_value());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (const auto rig = taken([&] { return rptv::parse_rig(text, "file"); })) {
    const std::string printed = rptv::to_toml(*rig);
    require(rptv::to_toml(rptv::parse_rig(printed, "file")) == printed);
    for (const auto& camera : rig->cameras) look_through(camera.model);
  }
  // OpenPTV's three files, one after the other behind a form feed
  const std::size_t first = std::min(text.find('\f'), size), second = std::min(text.find('\f', first + 1), size);
  const auto part = [&](std::size_t from, std::size_t to) {
    return from < to ? text.substr(from, to - from) : text.substr(0, 0);
  };
  auto camera = taken([&] { return rptv::parse_openptv_ori(part(0, first), "file"); });
  const auto added = taken([&] {
    rptv::OpenptvCamera other;
    rptv::parse_openptv_addpar(part(first + 1, second), "file", camera ? *camera : other);
    return true;
  });
  const auto setup = taken([&] { return rptv::parse_openptv_setup(part(second + 1, size), "file"); });
  if (setup)
    require(rptv::openptv_setup(rptv::parse_openptv_setup(rptv::openptv_setup(*setup), "file")) ==
            rptv::openptv_setup(*setup));
  if (camera && added && setup)
    if (const auto model =
            taken([&] { return rptv::from_openptv(*camera, *setup, rptv::OpenptvScale::columns, "file"); }))
      look_through(*model);
  if (const auto points = taken([&] { return rptv::parse_lpt_points(text, "file"); }))
    require(rptv::parse_lpt_points(rptv::lpt_points_text(*points), "file").size() == points->size());
  return 0;
}
