// SPDX-License-Identifier: MIT
// Sections of the configuration, paths relative to its file, and its text as TOML and JSON.
#include "daemon/config.hpp"

#include <cerrno>
#include <fstream>
#include <iterator>
#include <system_error>

#include <fmt/format.h>

#include "core/error.hpp"
#include "core/json.hpp"

namespace rptv {

namespace fs = std::filesystem;

void SourceSettings::fields(FieldList& list) {
  list.choice("kind", kind, {"replay", "aravis", "v4l2"},
              "where frames come from: 'replay' plays images, 'aravis' takes GenICam cameras, 'v4l2' cameras of the "
              "kernel; see the section of that name");
}

void IntakeSettings::fields(FieldList& list) {
  list.choice("policy", policy, {"newest", "lossless", "bounded"},
              "when reconstruction falls behind: take the newest frame, make the source wait, or queue up to depth");
  list.integer("depth", depth, 1, 4096, "frames that may wait under policies lossless and bounded");
  list.integer("pool_frames", pool_frames, 2, 65536, "frames of memory per camera, taken at start");
  list.integer("bundle_patience", bundle_patience, 1, 1024,
               "newer frames of one camera that may come before an incomplete set of several cameras is given up");
  list.number("silence_alarm_s", silence_alarm_s, 0.01, 86400,
              "a camera without a frame for so long (three periods if those are longer) raises a warning, s");
}

IntakeOptions IntakeSettings::options() const {
  IntakeOptions options;
  const auto frames = static_cast<std::size_t>(depth);
  if (policy == "lossless") options.policy = Lossless{frames};
  if (policy == "bounded") options.policy = Bounded{frames};
  options.pool_frames_per_camera = static_cast<std::size_t>(pool_frames);
  options.bundle_patience_frames = static_cast<std::size_t>(bundle_patience);
  return options;
}

void ReconstructionSettings::fields(FieldList& list) {
  list.choice(
      "kind", kind, {"light_field", "multi_view"},
      "'light_field': one camera behind a microlens array; 'multi_view': 2 to 16 cameras of a rig; see the section "
      "of that name");
  list.choice("backend", backend, {"auto", "cuda", "cpu"},
              "'auto': an NVIDIA GPU where there is one that can be used, else the CPU; 'cuda': the GPU or an error; "
              "particles are the same");
}

void OutputSettings::fields(FieldList& list) {
  list.text("tracks", tracks, "CSV file that tracks are written to; '-' is standard output; empty: none");
  list.text("points", points, "CSV file that particles are written to; '-' is standard output; empty: none");
}

void Config::fields(FieldList& list) {
  list.section("source", source);
  list.section("replay", replay);
  list.section("aravis", aravis);
  list.section("v4l2", v4l2);
  list.section("intake", intake);
  list.section("sync", sync);
  list.section("reconstruction", reconstruction);
  list.section("light_field", light_field);
  list.section("multi_view", multi_view);
  list.section("linker", linker);
  list.section("publisher", publisher);
  list.section("output", output);
}

std::size_t Config::max_particles() const {
  return static_cast<std::size_t>(reconstruction.is_multi_view() ? multi_view.max_particles
                                                                 : light_field.max_particles);
}

const std::string& Config::calibration_file() const {
  return reconstruction.is_multi_view() ? multi_view.rig : light_field.calibration;
}

std::string Config::calibration_text() const {
  const std::string& file = calibration_file();
  if (file.empty()) return {};
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  const int reason = errno;
  if (!stream)
    throw Error(reason == EACCES ? ExitCode::permission : ExitCode::no_input,
                file + ": " + std::generic_category().message(reason) + "; mend " +
                    (reconstruction.is_multi_view() ? "multi_view.rig" : "light_field.calibration"));
  return {std::istreambuf_iterator<char>(stream), {}};
}

namespace {

/// Paths in a file count from the file's own folder, wherever the daemon is started.
void resolve_paths(Config& config, const fs::path& origin) {
  const fs::path folder = fs::absolute(origin).parent_path();
  const auto resolve = [&](std::string& path) {
    if (!path.empty() && path != "-") path = (folder / path).lexically_normal().string();
  };
  for (std::string* path :
       {&config.replay.path, &config.light_field.calibration, &config.light_field.background_image,
        &config.multi_view.rig, &config.publisher.curve_secret_key_file, &config.output.tracks, &config.output.points})
    resolve(*path);
  for (std::string& path : config.multi_view.detector.background_images) resolve(path);
}

struct JsonValue {
  std::string operator()(const bool* value) const { return *value ? "true" : "false"; }
  std::string operator()(const std::int64_t* value) const { return fmt::format("{}", *value); }
  std::string operator()(const double* value) const { return json_number(*value); }
  std::string operator()(const std::string* value) const { return json_string(*value); }
  std::string operator()(const std::vector<std::string>* values) const {
    std::string list;
    for (const auto& value : *values) list += (list.empty() ? "" : ", ") + json_string(value);
    return "[" + list + "]";
  }
  std::string operator()(const std::vector<double>* values) const {
    std::string list;
    for (const double& value : *values) list += (list.empty() ? "" : ", ") + (*this)(&value);
    return "[" + list + "]";
  }
};

/// One object: the fields below `prefix`, which are adjacent, sections nested.
std::string json_object(const std::vector<Field>& fields, const std::string& prefix, const std::string& first) {
  std::string text = first, done;
  for (const auto& field : fields) {
    if (!field.path.starts_with(prefix)) continue;
    const std::string rest = field.path.substr(prefix.size());
    const std::string name = rest.substr(0, rest.find('.'));
    if (name == done) continue;
    done = name;
    text += (text.empty() ? "" : ", ") + json_string(name) + ": ";
    text += name == rest ? std::visit(JsonValue{}, field.target) : json_object(fields, prefix + name + ".", "");
  }
  return "{" + text + "}";
}

Config finish(Config config, const fs::path& origin, const std::vector<std::string>& set) {
  resolve_paths(config, origin);
  FieldList list;
  config.fields(list);
  for (const auto& assignment : set) set_field(list, assignment);
  return config;
}

}  // namespace

Config load_config(const fs::path& file, const std::vector<std::string>& set) {
  Config config;
  FieldList list;
  config.fields(list);
  read_toml_file(file, "configuration", Config::kSchema, list);
  return finish(std::move(config), file, set);
}

Config parse_config(std::string_view text, const fs::path& origin, const std::vector<std::string>& set) {
  Config config;
  FieldList list;
  config.fields(list);
  read_toml_text(text, origin.string(), "configuration", Config::kSchema, list);
  return finish(std::move(config), origin, set);
}

std::string to_toml(const Config& config) {
  Config copy = config;
  FieldList list;
  copy.fields(list);
  return to_toml(list, Config::kSchema);
}

std::string to_json(const Config& config) {
  Config copy = config;
  FieldList list;
  copy.fields(list);
  return json_object(list.all(), "", fmt::format("\"schema\": {}", Config::kSchema));
}

}  // namespace rptv
