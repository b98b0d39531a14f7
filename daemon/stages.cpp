// SPDX-License-Identifier: MIT
// Which source and which reconstruction a configuration asks for.
#include <vector>

#ifdef RPTV_ARAVIS
#include "acquisition/aravis_source.hpp"
#endif
#include "acquisition/v4l2_source.hpp"
#include "calibration/light_field_calibration.hpp"
#include "core/error.hpp"
#include "daemon/progress.hpp"
#include "daemon/session.hpp"
#include "reconstruct/light_field.hpp"
#include "replay/image_file.hpp"
#include "replay/replay_source.hpp"

namespace rptv {

namespace {

std::unique_ptr<Source> make_aravis_source(const Config& config) {
#ifdef RPTV_ARAVIS
  return std::make_unique<AravisSource>(config.aravis, static_cast<std::size_t>(config.intake.pool_frames));
#else
  throw Error(ExitCode::configuration,
              "source.kind = '" + config.source.kind +
                  "', but this rapidptv was built without Aravis; build it with RPTV_ARAVIS=ON");
#endif
}

}  // namespace

std::unique_ptr<Source> make_source(const Config& config) {
  if (config.source.kind == "aravis") return make_aravis_source(config);
  if (config.source.kind == "v4l2")
    return std::make_unique<V4l2Source>(config.v4l2, static_cast<std::size_t>(config.intake.pool_frames));
  std::unique_ptr<Progress> bar;
  return std::make_unique<ReplaySource>(config.replay, [&bar](std::size_t done, std::size_t total) {
    if (!bar) bar = std::make_unique<Progress>("decode", total);
    bar->advance(done - bar->done());
  });
}

IntakeOptions make_intake_options(const Config& config, const Source& source) {
  IntakeOptions options = config.intake.options();
  if (config.source.is_live()) config.sync.apply(options, source.cameras().size(), source.nominal_period_ns());
  return options;
}

std::string sync_warning(const Config& config, const Source& source) {
  return config.source.is_live() ? config.sync.warning(source.cameras().size()) : std::string();
}

std::unique_ptr<Reconstructor> make_reconstructor(const Config& config, const std::vector<CameraInfo>& cameras) {
  if (cameras.size() != 1)
    throw Error(ExitCode::configuration, "a light field has one camera and the source has " +
                                             std::to_string(cameras.size()) + "; give one camera's folder as its path");
  const LightFieldSettings& settings = config.light_field;
  if (settings.calibration.empty())
    throw Error(ExitCode::configuration,
                "light_field.calibration is empty; name the calibration file in the configuration or with --set");
  const LightFieldCalibration calibration = read_light_field_calibration(settings.calibration);
  const ImageShape& shape = cameras.front().shape;
  if (shape.width_px != calibration.sensor.width_px || shape.height_px != calibration.sensor.height_px)
    throw Error(ExitCode::configuration, settings.calibration + ": made for " +
                                             std::to_string(calibration.sensor.width_px) + " x " +
                                             std::to_string(calibration.sensor.height_px) + " px and the images have " +
                                             std::to_string(shape.width_px) + " x " + std::to_string(shape.height_px) +
                                             "; use the calibration of this camera and region of interest");
  std::vector<std::byte> pixels;
  ImageView background;
  if (!settings.background_image.empty()) {
    const auto reader = open_image(settings.background_image);
    background.shape = reader->header(0).shape;
    if (background.shape != shape)
      throw Error(ExitCode::configuration, settings.background_image +
                                               ": has another size or depth than the images; record it with the same "
                                               "camera settings");
    pixels.resize(background.shape.bytes());
    reader->decode(0, pixels);
    background.data = pixels.data();
  }
  return std::make_unique<LightField>(settings, calibration, background);
}

}  // namespace rptv
