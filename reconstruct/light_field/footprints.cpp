// SPDX-License-Identifier: MIT
// Rendered at a lenslet in the middle of the sensor.
#include "reconstruct/light_field/footprints.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"

namespace rptv {

namespace {
constexpr float kFaint = 0.1F;                  // of its brightest pixel: left out of the search
constexpr std::size_t kSampled = 6;             // every so manieth pixel decides whether the others are worth a look
constexpr std::size_t kMostPixels = 1 << 16;    // of an image
constexpr std::size_t kMostEntries = 1U << 24;  // of the table
}  // namespace

Footprints::Footprints(const LightFieldCalibration& calibration, const LensletLattice& lattice,
                       const ImageModelOptions& model, const FootprintGrid& grid)
    : lattice_(lattice),
      grid_(grid),
      chief_(calibration),
      stride_(static_cast<std::int32_t>(calibration.sensor.width_px)),
      pixel_mm_(calibration.pixel_mm()),
      axis_px_(calibration.optical_axis_px()) {
  ImageModel images(calibration, lattice, model);
  ParticleImage image(kMostPixels);
  const std::uint32_t middle = lattice.columns() * (lattice.rows() / 2) + lattice.columns() / 2;
  const double depths = std::max(1.0, std::round((grid.highest_z_mm - grid.lowest_z_mm) / grid.depth_step_mm));
  const auto places = static_cast<std::size_t>(grid.places);
  footprints_.resize(static_cast<std::size_t>(depths) * places * places);
  std::size_t pixels = 0;
  for (std::size_t k = 0; k < footprints_.size(); ++k) {
    footprints_[k].first = static_cast<std::uint32_t>(pixels_.size());
    if (!images.render(at(k, middle), image))
      throw Error(
          ExitCode::configuration,
          "light_field.refine_search = \"grey_values\" cannot hold the image of a particle, which lights too many "
          "pixels of too many lenslets; stop the lens down, or set refine_search = \"rays\"");
    pixels += image.size;
    most_pixels_ = std::max(most_pixels_, image.size);
    add(image, spot_px(middle), footprints_[k]);
    if (pixels_.size() > kMostEntries)
      throw Error(ExitCode::configuration,
                  fmt::format("light_field.refine_search = \"grey_values\" tries {} depths and {} x {} places, which "
                              "takes too much memory for images of {} pixels; make volume_z_mm smaller, or set "
                              "refine_search = \"rays\"",
                              depths, places, places, image.size));
  }
  mean_pixels_ = pixels / footprints_.size();
}

void Footprints::add(const ParticleImage& image, std::array<std::int32_t, 2> spot, Footprint& f) {
  const float least =
      kFaint * *std::max_element(image.value.begin(), image.value.begin() + static_cast<std::ptrdiff_t>(image.size));
  const auto take = [&](bool sampled) {
    std::size_t seen = 0;
    for (std::size_t i = 0; i < image.size; ++i) {
      if (image.value[i] < least || (seen++ % kSampled == 0) != sampled) continue;
      const auto pixel = static_cast<std::int32_t>(image.pixel[i]);
      const std::int32_t column = pixel % stride_ - spot[0], row = pixel / stride_ - spot[1];
      pixels_.push_back({row * stride_ + column, static_cast<std::int16_t>(column), static_cast<std::int16_t>(row),
                         image.value[i], 0, 0});
      f.left = std::min(f.left, column), f.right = std::max(f.right, column);
      f.top = std::min(f.top, row), f.bottom = std::max(f.bottom, row);
    }
    return static_cast<std::uint32_t>(pixels_.size()) - f.first;
  };
  f.sampled = take(true);
  f.count = take(false);
}

void Footprints::set_light(double light, double dark_variance, double variance_per_grey) noexcept {
  const auto l = static_cast<float>(light), dark = static_cast<float>(dark_variance),
             per_grey = static_cast<float>(variance_per_grey);
  for (auto& f : footprints_) {
    f.norm = f.grey = 0;
    for (std::uint32_t i = 0; i < f.count; ++i) {
      Pixel& pixel = pixels_[f.first + i];
      pixel.grey = l * pixel.share;
      pixel.weighted = pixel.grey / (dark + per_grey * pixel.grey);
      f.norm += pixel.grey * pixel.weighted;
      f.grey += pixel.grey;
      if (i + 1 == f.sampled) f.sampled_norm = f.norm;
    }
  }
}

std::array<std::int32_t, 2> Footprints::spot_px(std::uint32_t lenslet) const noexcept {
  const auto spot = lattice_.spot_mm(lenslet);
  return {static_cast<std::int32_t>(std::lround(spot[0] / pixel_mm_ + axis_px_[0])),
          static_cast<std::int32_t>(std::lround(spot[1] / pixel_mm_ + axis_px_[1]))};
}

ImagePoint Footprints::at(std::size_t footprint, std::uint32_t lenslet) const noexcept {
  const auto places = static_cast<std::size_t>(grid_.places);
  const auto in_cell = [&](std::size_t place) {
    return ((static_cast<double>(place) + 0.5) / grid_.places - 0.5) * lattice_.pitch_mm();
  };
  const double along = in_cell(footprint % places), across = in_cell(footprint / places % places);
  const double depth = static_cast<double>(footprint / places / places) + 0.5;
  const auto centre = lattice_.centre_mm(lenslet);
  const double cosine = lattice_.rotation_cosine(), sine = lattice_.rotation_sine();
  const ImagePoint on_array{static_cast<double>(centre[0]) + cosine * along - sine * across,
                            static_cast<double>(centre[1]) + sine * along + cosine * across, 0};
  return chief_.slide(on_array, grid_.lowest_z_mm + depth * grid_.depth_step_mm);
}

}  // namespace rptv
