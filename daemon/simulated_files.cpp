// SPDX-License-Identifier: MIT
// Folders, texts and tables of simulated runs.
#include "daemon/simulated_files.hpp"

#include <fmt/format.h>

#include <fstream>

#include "core/csv.hpp"
#include "core/error.hpp"

namespace rptv {

namespace fs = std::filesystem;

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    throw Error(
        error == std::errc::permission_denied ? ExitCode::permission : ExitCode::io,
        fmt::format("{}: cannot create the folder ({}); choose another with --out", folder.string(), error.message()));
}

void remove_frames(const fs::path& frames) {
  for (const auto& entry : fs::directory_iterator(frames)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("frame_") && name.ends_with(".png")) fs::remove(entry.path());
  }
}

void write_text(const fs::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  out << text;
  if (!out.flush()) throw Error(ExitCode::io, file.string() + ": cannot write; check the disk and the permissions");
}

void write_times(const ScenarioSettings& scenario, const fs::path& file) {
  CsvWriter times(file, "frame,t");
  for (std::uint64_t frame = 0; frame < static_cast<std::uint64_t>(scenario.frames); ++frame)
    times.index(frame).number(static_cast<double>(frame) / scenario.rate_hz).end_row();
  times.close();
}

std::string scenario_toml(ScenarioSettings scenario) {
  FieldList list;
  scenario.fields(list);
  return to_toml(list, kScenarioSchema);
}

}  // namespace rptv
