// SPDX-License-Identifier: MIT
// `rapidptv cameras`: what answers, and what the configuration calls it.
#include <fmt/format.h>

#include <iostream>

#include "acquisition/found_camera.hpp"
#include "core/json.hpp"
#include "daemon/commands/command.hpp"

namespace rptv {
namespace {

std::string to_json(const FoundCamera& camera) {
  std::string formats;
  for (const auto& format : camera.formats) formats += (formats.empty() ? "" : ", ") + json_string(format);
  return fmt::format(
      R"({{"bus": {}, "address": {}, "vendor": {}, "model": {}, "serial": {}, "formats": [{}], "problem": {}}})",
      json_string(camera.bus), json_string(camera.address), json_string(camera.vendor), json_string(camera.model),
      json_string(camera.serial), formats, json_string(camera.problem));
}

ExitCode list_cameras(bool json) {
  std::vector<FoundCamera> all;
#ifdef RPTV_ARAVIS
  all = find_aravis_cameras();
#endif
  V4l2System system;
  for (auto& camera : find_v4l2_cameras(system)) all.push_back(std::move(camera));
  if (json) {
    std::string list;
    for (const auto& camera : all) list += (list.empty() ? "" : ", ") + to_json(camera);
    std::cout << "{\"cameras\": [" + list + "]}\n" << std::flush;
    return ExitCode::ok;
  }
  for (const auto& camera : all) {
    std::string formats;
    for (const auto& format : camera.formats) formats += " " + format;
    std::cout << fmt::format("{:<11} {:<28} {} {} {}\n", camera.bus, camera.address, camera.vendor, camera.model,
                             camera.serial)
              << (camera.problem.empty() ? "           formats:" + formats : "           " + camera.problem) << "\n";
  }
  std::cout << std::flush;
  if (all.empty())
    std::cerr << "no camera answers; check power and cable, then `rapidptv doctor` for network and limits\n";
  return ExitCode::ok;
}

}  // namespace

void add_cameras(Command app, Action& chosen) {
  auto json = std::make_shared<bool>(false);
  Command command = app.add_subcommand("cameras", "List the cameras that answer: GigE Vision, USB3 Vision, V4L2");
  command.add_flag("--json", *json, "print one JSON object");
  command.footer(
      "The second column is what aravis.cameras and v4l2.devices name a camera by.\n"
      "Examples:\n"
      "  rapidptv cameras\n"
      "  rapidptv cameras --json | jq -r '.cameras[].address'");
  command.callback([json, &chosen] { chosen = [json] { return list_cameras(*json); }; });
}

}  // namespace rptv
