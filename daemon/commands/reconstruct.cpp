// SPDX-License-Identifier: MIT
// `rapidptv reconstruct`: images in, a table of points out.
#include <fmt/format.h>

#include <array>
#include <iostream>

#include "core/tables.hpp"
#include "daemon/backend.hpp"
#include "daemon/commands/command.hpp"
#include "daemon/commands/reconstruct_views.hpp"
#include "daemon/config.hpp"
#include "daemon/progress.hpp"
#include "daemon/session.hpp"
#include "reconstruct/light_field/light_field.hpp"
#include "replay/image_sequence.hpp"
#include "replay/timeline.hpp"

namespace rptv {
namespace {

namespace fs = std::filesystem;

struct ReconstructOptions {
  std::vector<std::string> images;
  std::string config, calibration, space, backend;
  std::string output = "-";
  double rate_hz = 0;
  std::vector<std::string> set;
};

Config resolve(const ReconstructOptions& options) {
  Config config =
      options.config.empty() ? parse_config("", "command line", options.set) : load_config(options.config, options.set);
  std::string& calibration =
      config.reconstruction.is_multi_view() ? config.multi_view.rig : config.light_field.calibration;
  if (!options.calibration.empty()) calibration = options.calibration;
  if (!options.space.empty()) config.light_field.space = options.space;
  if (!options.backend.empty()) config.reconstruction.backend = options.backend;
  if (options.rate_hz > 0) config.replay.rate_hz = options.rate_hz;
  if (options.images.size() == 1) config.replay.path = options.images.front();
  if (options.images.empty() && config.replay.path.empty())
    throw Error(ExitCode::usage, "no images; name files or a folder, or a --config whose replay.path does");
  if (calibration.empty())
    throw Error(ExitCode::usage, "no calibration; give --calibration, or a --config that names one");
  return config;
}

ImageSequence open_images(const ReconstructOptions& options, const Config& config) {
  if (options.images.size() > 1) return {"images", {options.images.begin(), options.images.end()}};
  auto cameras = open_cameras(config.replay.path, config.replay.pattern);
  if (cameras.size() != 1)
    throw Error(ExitCode::configuration,
                fmt::format("{}: has {} cameras and a light field has one; name one camera's folder, or set "
                            "reconstruction.kind = \"multi_view\"",
                            config.replay.path, cameras.size()));
  return std::move(cameras.front());
}

/// Time of each image in s; empty when neither a frames.csv nor a rate says.
std::vector<double> times_of(const ReconstructOptions& options, const Config& config, const ImageSequence& images) {
  std::vector<double> times;
  const bool one_path = options.images.size() <= 1;
  if (one_path && (config.replay.rate_hz > 0 || fs::exists(fs::path(config.replay.path) / "frames.csv"))) {
    const Timeline timeline = make_timeline(config.replay.path, {images}, config.replay.rate_hz, -1);
    for (const Shot& shot : timeline.shots.front()) times.push_back(static_cast<double>(shot.time_ns) * 1e-9);
  } else if (config.replay.rate_hz > 0) {
    for (std::size_t i = 0; i < images.size(); ++i)
      times.push_back(static_cast<double>(images.number(i)) / config.replay.rate_hz);
  }
  if (times.size() != images.size()) times.clear();
  return times;
}

void tell(const ImageSequence& images, const LightFieldCounts& counts, std::uint64_t particles) {
  std::cerr << fmt::format("reconstructed {} of {} images: {} particles\n", counts.frames, images.size(), particles);
  if (counts.refused_pixels > 0)
    std::cerr << fmt::format("{} lit pixels were left out: raise light_field.threshold or light_field.max_rays\n",
                             counts.refused_pixels);
  if (counts.refused_candidates > 0)
    std::cerr << fmt::format("{} voxels were left out: raise light_field.min_count or light_field.max_candidates\n",
                             counts.refused_candidates);
  if (counts.refused_particles > 0)
    std::cerr << fmt::format("{} particles were left out: raise light_field.max_particles\n", counts.refused_particles);
  if (counts.device_unsure > 0)
    std::cerr << fmt::format("{} times the CPU explained rays since the device was unsure; the results are the same\n",
                             counts.device_unsure);
}

ExitCode reconstruct(const ReconstructOptions& options) {
  const Config config = resolve(options);
  if (config.reconstruction.is_multi_view()) {
    if (options.images.size() > 1)
      throw Error(ExitCode::usage, "multi-view needs one folder that holds the images of all cameras; name that");
    return reconstruct_views(config, options.output);
  }
  const ImageSequence images = open_images(options, config);
  const std::vector<double> times = times_of(options, config, images);
  std::array<std::vector<std::byte>, kDeviceFrames> pixels;  // a device may read one while the next is decoded
  for (auto& buffer : pixels) buffer.resize(images.shape().bytes());
  std::string where;
  const auto stage = make_reconstructor(config, {{images.camera(), images.shape(), images.significant_bits()}}, &where);
  auto& light_field = dynamic_cast<LightField&>(*stage);
  std::cerr << where << '\n';
  for (auto& buffer : pixels) light_field.page_lock(buffer);
  for (const auto& warning : read_light_field_calibration(config.light_field.calibration).warnings())
    std::cerr << "warning: " << config.light_field.calibration << ": " << warning << '\n';
  PointsWriter points(options.output, {.covariance = true, .ghost = true, .time = !times.empty()});
  ImageSequence::Reader reader(images);
  Particles particles(static_cast<std::size_t>(config.light_field.max_particles));
  std::uint64_t total = 0;
  std::size_t done = 0;
  Progress progress("reconstructing", images.size());
  const auto finish_one = [&] {
    light_field.collect(particles);
    points.write(images.number(done), times.empty() ? kNoTime : times[done], particles);
    total += particles.size();
    ++done, progress.advance();
  };
  for (std::size_t i = 0; i < images.size(); ++i) {
    while (i - done >= light_field.most_in_flight()) finish_one();
    auto& buffer = pixels[i % pixels.size()];
    reader.decode(i, buffer);
    light_field.submit(ImageView{buffer.data(), images.shape()});
  }
  while (done < images.size()) finish_one();
  points.close();
  tell(images, light_field.counts(), total);
  if (stage->sets_without_device() > 0) std::cerr << device_failure(stage->sets_without_device()) << '\n';
  return ExitCode::ok;
}

}  // namespace

void add_reconstruct(Command app, Action& chosen) {
  auto options = std::make_shared<ReconstructOptions>();
  Command command =
      app.add_subcommand("reconstruct", "Find particles in light-field or multi-view images (images to CSV)");
  command.add_option(
      "images", options->images,
      "PNG or TIFF files of one camera, or one folder of them, or of all cameras of a rig; default: replay.path of the "
      "configuration");
  command.add_option("-c,--config", options->config, "configuration (TOML) with [light_field] or [multi_view]");
  command.add_option("--calibration", options->calibration, "light-field calibration or rig file (TOML)");
  command.add_option("--set", options->set, "override one setting: key=value").allow_extra_args(false);
  command.add_option("--space", options->space, "frame of reference of the points").one_of({"object", "image"});
  command.add_option("--backend", options->backend, "processor that reconstructs, instead of reconstruction.backend")
      .one_of({"auto", "cuda", "cpu"});
  command.add_option("--rate", options->rate_hz, "frames per second, for column t, where no frames.csv tells it")
      .range(1e-6, 1e9);
  command.add_option("-o,--output", options->output, "table of points; - is standard output").show_default();
  command.footer(
      "Columns: frame,x,y,z,residual,support and the covariance var_x,var_y,var_z,cov_xy,cov_xz,cov_yz (mm, mm^2), "
      "then "
      "ghost\n(probability that there is no such particle) and t (s) where it is known. Object space unless --space "
      "image: origin on the plane conjugate to the lenslet "
      "array, z "
      "towards\nthe lens.\n\n"
      "Examples:\n"
      "  rapidptv reconstruct frames/ --calibration cal.toml --set light_field.particle_radius_um=15 -o points.csv\n"
      "  rapidptv reconstruct a.png b.png --calibration cal.toml --set light_field.min_count=30 --space image\n"
      "  rapidptv reconstruct frames/ --set reconstruction.kind=multi_view --calibration rig.toml -o points.csv\n"
      "  rapidptv reconstruct --config rig.toml | rapidptv link - --search-range 0.5 > tracks.csv");
  command.callback([options, &chosen] { chosen = [options] { return reconstruct(*options); }; });
}

}  // namespace rptv
