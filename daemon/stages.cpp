// SPDX-License-Identifier: MIT
// Which source and which reconstruction a configuration asks for.
#include <vector>

#ifdef RPTV_ARAVIS
#include "acquisition/aravis_source.hpp"
#endif
#include "acquisition/v4l2_source.hpp"
#include "calibration/light_field/light_field_calibration.hpp"
#include "core/error.hpp"
#include "daemon/backend.hpp"
#include "daemon/progress.hpp"
#include "daemon/session.hpp"
#include "reconstruct/light_field/light_field.hpp"
#include "reconstruct/multi_view/iterative_views.hpp"
#include "reconstruct/multi_view/multi_view.hpp"
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

namespace {

/// An image that a setting names, decoded; no data where it names none.
class BackgroundImage {
 public:
  BackgroundImage(const std::string& file, const ImageShape& shape) {
    if (file.empty()) return;
    const auto reader = open_image(file);
    view_.shape = reader->header(0).shape;
    if (view_.shape != shape)
      throw Error(ExitCode::configuration, file +
                                               ": has another size or depth than the images; record it with the same "
                                               "camera settings");
    pixels_.resize(view_.shape.bytes());
    reader->decode(0, pixels_);
    view_.data = pixels_.data();
  }
  const ImageView& view() const { return view_; }

 private:
  std::vector<std::byte> pixels_;
  ImageView view_;
};

std::unique_ptr<Reconstructor> make_light_field(const Config& config, const std::vector<CameraInfo>& cameras,
                                                Backend& backend) {
  if (cameras.size() != 1)
    throw Error(ExitCode::configuration,
                "a light field has one camera and the source has " + std::to_string(cameras.size()) +
                    "; give one camera's folder as its path, or set reconstruction.kind = \"multi_view\"");
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
  const BackgroundImage background(settings.background_image, shape);
  return std::make_unique<LightField>(settings, calibration, background.view(), [&](const LightFieldDevicePlan& plan) {
    return make_tried_device(config, plan, backend);
  });
}

std::unique_ptr<Reconstructor> make_multi_view(const Config& config, const std::vector<CameraInfo>& cameras,
                                               Backend& backend) {
  const MultiViewSettings& settings = config.multi_view;
  if (settings.rig.empty())
    throw Error(ExitCode::configuration,
                "multi_view.rig is empty; name the rig file in the configuration or with --set");
  const std::vector<std::string>& files = settings.detector.background_images;
  if (!files.empty() && files.size() != cameras.size())
    throw Error(ExitCode::configuration, "multi_view.detector.background_images names " + std::to_string(files.size()) +
                                             " images and the source has " + std::to_string(cameras.size()) +
                                             " cameras; name one for each, or none");
  std::vector<BackgroundImage> backgrounds;
  std::vector<MultiViewCamera> views;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    backgrounds.emplace_back(files.empty() ? std::string() : files[c], cameras[c].shape);
    views.push_back({cameras[c].name, cameras[c].shape, backgrounds.back().view()});
  }
  if (settings.method == "iterative") return std::make_unique<IterativeViews>(settings, read_rig(settings.rig), views);
  return std::make_unique<MultiView>(settings, read_rig(settings.rig), views, [&](const DetectDevicePlan& plan) {
    return make_tried_device(config, plan, backend);
  });
}

}  // namespace

std::unique_ptr<Reconstructor> make_reconstructor(const Config& config, const std::vector<CameraInfo>& cameras,
                                                  std::string* where) {
  Backend backend = choose_backend(config);
  auto reconstructor = config.reconstruction.is_multi_view() ? make_multi_view(config, cameras, backend)
                                                             : make_light_field(config, cameras, backend);
  if (where != nullptr) *where = backend.text;
  return reconstructor;
}

}  // namespace rptv
