// SPDX-License-Identifier: MIT
// The daemon's configuration: the settings of every stage, from one TOML file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "acquisition/aravis_settings.hpp"
#include "acquisition/intake.hpp"
#include "acquisition/sync_settings.hpp"
#include "acquisition/v4l2_settings.hpp"
#include "core/settings.hpp"
#include "daemon/publisher.hpp"
#include "reconstruct/light_field/light_field_settings.hpp"
#include "reconstruct/multi_view/multi_view_settings.hpp"
#include "replay/replay_settings.hpp"
#include "tracking/linker_settings.hpp"

namespace rptv {

/// Where frames come from; each kind has a section of its own name.
struct SourceSettings {
  std::string kind = "replay";
  bool is_live() const { return kind != "replay"; }
  void fields(FieldList& list);
};

/// What happens to frames when reconstruction falls behind, and how much memory they may take.
struct IntakeSettings {
  std::string policy = "newest";
  std::int64_t depth = 8;
  std::int64_t pool_frames = 16;
  std::int64_t bundle_patience = 4;
  double silence_alarm_s = 2;

  void fields(FieldList& list);
  IntakeOptions options() const;
};

/// Which instrument the images are of (each kind has a section of its own name), and which processor reconstructs.
struct ReconstructionSettings {
  std::string kind = "light_field";
  std::string backend = "auto";
  bool is_multi_view() const { return kind == "multi_view"; }
  void fields(FieldList& list);
};

/// Files that a run writes beside publishing.
struct OutputSettings {
  std::string tracks, points;
  void fields(FieldList& list);
};

/// A plain value; every field has a default, so `Config{}` is what `show-config` prints without a file.
struct Config {
  static constexpr std::int64_t kSchema = 1;
  SourceSettings source;
  ReplaySettings replay;
  AravisSettings aravis;
  V4l2Settings v4l2;
  IntakeSettings intake;
  SyncSettings sync;
  ReconstructionSettings reconstruction;
  LightFieldSettings light_field;
  MultiViewSettings multi_view;
  LinkerSettings linker;
  PublisherSettings publisher;
  OutputSettings output;

  void fields(FieldList& list);
  /// Of the reconstruction that is chosen: room for particles, and the path of its calibration or rig.
  std::size_t max_particles() const;
  const std::string& calibration_file() const;
  /// The calibration or rig file as it is; empty when none is named. Throws Error(no_input, permission).
  std::string calibration_text() const;
};

/// Reads `file`, makes the relative paths in it absolute (they count from the file's own folder), then applies the
/// `key=value` assignments of a command line, whose paths count from the working directory. Set-up only. Throws Error:
/// configuration (`rig.toml:5:16: …`), no_input, permission; usage for a bad assignment.
Config load_config(const std::filesystem::path& file, const std::vector<std::string>& set = {});

/// The same from text; `origin` stands for the file's name in messages and gives the folder that paths count from.
Config parse_config(std::string_view text, const std::filesystem::path& origin,
                    const std::vector<std::string>& set = {});

/// The configuration as a TOML file with a comment per key: parse_config() of it gives the same values back.
std::string to_toml(const Config& config);
/// The same values as one JSON object, sections nested.
std::string to_json(const Config& config);

}  // namespace rptv
