// SPDX-License-Identifier: MIT
// Sharp images of the pupil's pieces, one a lenslet, then diffraction as a separable filter.
#include "reconstruct/light_field/particle_image.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/error.hpp"
#include "reconstruct/light_field/blur_kernel.hpp"
#include "reconstruct/light_field/particle_image_cpu.hpp"
#include "reconstruct/light_field/particle_image_merge.hpp"

namespace rptv {

namespace {
constexpr std::size_t kLongestFilter = 12;
constexpr float kEdgeSigmas = 3.0F;                // how far a blurred border is followed
constexpr std::size_t kMostPatchPixels = 1 << 14;  // with the room for its blur
constexpr std::int32_t kWidestPatch = 512;
// Dark room before and behind a plane, for a filter that reaches out of it.
constexpr std::size_t kGuard = static_cast<std::size_t>(kWidestPatch) * (kLongestFilter + 1);
constexpr std::size_t kPlane = kMostPatchPixels + kGuard;
constexpr std::size_t kMostPatches = 512;
constexpr std::size_t kMostBoxPixels = 1 << 19;
constexpr float kFaintest = 1e-3F;  // of the light of a pixel that nothing cuts
}  // namespace

ImageModel::ImageModel(const LightFieldCalibration& calibration, const LensletLattice& lattice,
                       const ImageModelOptions& options)
    : lattice_(lattice),
      options_(options),
      filter_(diffraction_filter(options.diffraction_zero_um, calibration.sensor.pixel_um, kLongestFilter)),
      width_(static_cast<std::int32_t>(calibration.sensor.width_px)),
      height_(static_cast<std::int32_t>(calibration.sensor.height_px)),
      reach_(static_cast<std::int32_t>(filter_.size()) - 1),
      pixel_mm_(static_cast<float>(calibration.pixel_mm())),
      focal_mm_(static_cast<float>(calibration.lenslets.focal_length_mm)),
      axis_x_px_(static_cast<float>(calibration.optical_axis_px()[0])),
      axis_y_px_(static_cast<float>(calibration.optical_axis_px()[1])),
      per_pupil_distance_(calibration.lens.exit_pupil_mm > 0 ? 1 / calibration.lens.exit_pupil_mm : 0),
      slope_sigma_(std::hypot(calibration.pixel_mm() / std::sqrt(12.0), options.spread_um * 1e-3) /
                   calibration.lenslets.focal_length_mm),
      rim_shift_(calibration.lens.rim_shift),
      rim_radius_mm_(calibration.lens.rim_radius_mm),
      planes_(4 * kPlane + kGuard),
      line_(kPlane + kGuard),
      place_(kMostBoxPixels) {
  patches_.resize(kMostPatches);
  if (!(options.pupil_radius_mm > 0))
    throw Error(ExitCode::configuration,
                "light_field.refine needs the size of the pupil; give lens.image_f_number in the calibration, or set "
                "light_field.refine = false");
}

float* ImageModel::plane(std::size_t k) noexcept { return planes_.data() + kGuard + k * kPlane; }
const float* ImageModel::plane(std::size_t k) const noexcept { return planes_.data() + kGuard + k * kPlane; }

double ImageModel::reach_px(double depth_mm) const noexcept {
  const double far = per_pupil_distance_ > 0 ? 1 / per_pupil_distance_ - std::abs(depth_mm) : 1;
  const double slope = options_.pupil_radius_mm / std::max(far, 1e-3) + kEdgeSigmas * slope_sigma_;
  const double on_array_mm = slope * std::abs(depth_mm) + 2 * options_.particle_radius_mm + lattice_.pitch_mm();
  return (on_array_mm + slope * static_cast<double>(focal_mm_)) / static_cast<double>(pixel_mm_) + reach_ + 2;
}

// Slopes at which this lenslet can see the particle: the pupil's box, cut by the cell's.
bool ImageModel::range_of(const ParticleView& view, float c_x, float c_y, Range& range) const noexcept {
  const float far = 1 / view.to_pupil;
  const float pupil = (view.pupil_radius + kEdgeSigmas * 0.70711F / view.pupil_edge) * far;
  const float chief_x = -view.with_position * view.x * far, chief_y = -view.with_position * view.y * far;
  range = {chief_x - pupil, chief_x + pupil, chief_y - pupil, chief_y + pupil};
  const float cell =
      view.half_pitch * (std::abs(view.cosine) + std::abs(view.sine)) + kEdgeSigmas * 0.70711F / view.edge;
  const auto cut = [&](float to_centre, float& low, float& high) {  // |to_centre - slope·z| <= cell
    if (std::abs(view.z) * (high - low) < 1e-3F * view.half_pitch) return std::abs(to_centre - low * view.z) <= cell;
    const float a = (to_centre - cell) / view.z, b = (to_centre + cell) / view.z;
    low = std::max(low, std::min(a, b)), high = std::min(high, std::max(a, b));
    return low < high;
  };
  return cut(view.x - c_x, range.low_x, range.high_x) && cut(view.y - c_y, range.low_y, range.high_y);
}

bool ImageModel::render(const ImagePoint& at, ParticleImage& out) noexcept {
  out.size = 0;
  patch_count_ = 0;
  overlap_ = false;
  if (per_pupil_distance_ > 0 && !(at.z * per_pupil_distance_ < 0.9)) return false;
  const ParticleView view = view_of(at);
  const double pupil = (options_.pupil_radius_mm + 2 / static_cast<double>(view.pupil_edge)) / view.to_pupil;
  const double half_mm = pupil * std::abs(at.z) + 2 / static_cast<double>(view.edge);
  const double shrink = 1 + at.z * view.with_position / view.to_pupil;  // of the chief ray, from particle to array
  const auto [u, v] = lattice_.on_true_lattice(at.x * shrink, at.y * shrink);
  const double turn = std::abs(lattice_.rotation_cosine()) + std::abs(lattice_.rotation_sine());
  const double half = turn * half_mm / lattice_.pitch_mm() + 0.5;
  const double low_u = std::max(std::ceil(u - half), 0.0),
               high_u = std::min(std::floor(u + half), lattice_.columns() - 1.0);
  const double low_v = std::max(std::ceil(v - half), 0.0),
               high_v = std::min(std::floor(v + half), lattice_.rows() - 1.0);
  if (!(low_u <= high_u && low_v <= high_v)) return false;
  for (auto row = static_cast<std::uint32_t>(low_v); row <= static_cast<std::uint32_t>(high_v); ++row)
    for (auto column = static_cast<std::uint32_t>(low_u); column <= static_cast<std::uint32_t>(high_u); ++column) {
      const auto [c_x, c_y] = lattice_.centre_mm(row * lattice_.columns() + column);
      Range range{};
      if (range_of(view, c_x, c_y, range) && !add_patch(view, c_x, c_y, range, out)) return false;
    }
  return (!overlap_ || merge(out)) && out.size > 0;
}

// The patch of a lenslet with room for the blur all round, as it lies on the sensor and perhaps beyond.
ImageModel::Patch ImageModel::patch_of(float c_x, float c_y, const Range& range) const noexcept {
  const auto pixel = [this](float mm, float axis) {
    return static_cast<std::int32_t>(std::floor(std::clamp(mm / pixel_mm_ + axis + 0.5F, -1e6F, 1e6F)));
  };
  const std::int32_t left = pixel(c_x - focal_mm_ * range.high_x, axis_x_px_);
  const std::int32_t right = pixel(c_x - focal_mm_ * range.low_x, axis_x_px_);
  const std::int32_t top = pixel(c_y - focal_mm_ * range.high_y, axis_y_px_);
  const std::int32_t bottom = pixel(c_y - focal_mm_ * range.low_y, axis_y_px_);
  // Whole blocks of lit pixels, and rows of whole blocks: what is too much is dark.
  const auto blocks = [](std::int32_t pixels) {
    constexpr auto kBlock = static_cast<std::int32_t>(kPixelBlock);
    return (pixels + kBlock - 1) / kBlock * kBlock;
  };
  const std::int32_t width = blocks(blocks(right - left + 1) + 2 * reach_);
  return {left - reach_, top - reach_, width, bottom - top + 1 + 2 * reach_};
}

// False: no room.
bool ImageModel::add_patch(const ParticleView& view, float c_x, float c_y, const Range& range,
                           ParticleImage& out) noexcept {
  const Patch patch = patch_of(c_x, c_y, range);
  if (patch.column >= width_ || patch.row >= height_ || patch.column + patch.width <= 0 ||
      patch.row + patch.height <= 0)
    return true;
  if (static_cast<std::size_t>(patch.width) * static_cast<std::size_t>(patch.height) > kMostPatchPixels ||
      patch.width > kWidestPatch || patch_count_ == kMostPatches)
    return false;
  light_up(view, c_x, c_y, patch);
  for (std::size_t k = 0; k < 4 && reach_ > 0; ++k) blur(plane(k), patch);
  overlap_ = overlap_ || std::any_of(patches().begin(), patches().end(), [&](const Patch& other) {
               return patch.column < other.column + other.width && other.column < patch.column + patch.width &&
                      patch.row < other.row + other.height && other.row < patch.row + patch.height;
             });
  patches_[patch_count_++] = patch;
  return copy_seen(patch, kFaintest * view.light, out);
}

void ImageModel::light_up(const ParticleView& view, float c_x, float c_y, const Patch& patch) noexcept {
  const std::int32_t lit =
      (patch.width - 2 * reach_) / static_cast<std::int32_t>(kPixelBlock) * static_cast<std::int32_t>(kPixelBlock);
  const float per_focal = 1 / focal_mm_, step = pixel_mm_ * per_focal;
  const float s_x = (c_x - (static_cast<float>(patch.column + reach_) - axis_x_px_) * pixel_mm_) * per_focal;
  for (std::int32_t j = reach_; j < patch.height - reach_; ++j) {
    const float s_y = (c_y - (static_cast<float>(patch.row + j) - axis_y_px_) * pixel_mm_) * per_focal;
    const std::ptrdiff_t first = std::ptrdiff_t{j} * patch.width + reach_;
    for (std::size_t k = 0; k < 4; ++k) {  // the dark rim beside the row
      std::fill_n(plane(k) + first - reach_, reach_, 0.0F);
      std::fill_n(plane(k) + first + lit, patch.width - lit - reach_, 0.0F);
    }
    light_row(view,
              {c_x, c_y, s_x, step, s_y, lit, plane(0) + first, plane(1) + first, plane(2) + first, plane(3) + first});
  }
}

// Along x, then along y. The dark rim beside a row keeps what leaves it from the next, so that the rows are one line.
void ImageModel::blur(float* plane, const Patch& patch) noexcept {
  const std::ptrdiff_t rim = std::ptrdiff_t{patch.width} * reach_;
  const std::ptrdiff_t count = std::ptrdiff_t{patch.width} * patch.height, lit = count - 2 * rim;
  std::fill_n(plane + rim - reach_, reach_, 0.0F);
  std::fill_n(plane + count - rim, reach_, 0.0F);
  float* line = line_.data() + kGuard;
  filter_line(plane + rim, line + rim, lit, 1, filter_.data(), reach_);
  std::fill_n(line - rim, 2 * rim, 0.0F);
  std::fill_n(line + count - rim, 2 * rim, 0.0F);
  filter_line(line, plane, count, patch.width, filter_.data(), reach_);
}

bool ImageModel::copy_seen(const Patch& patch, float least, ParticleImage& out) const noexcept {
  const std::int32_t first_x = std::max(patch.column, 0), last_x = std::min(patch.column + patch.width, width_);
  const std::int32_t first_y = std::max(patch.row, 0), last_y = std::min(patch.row + patch.height, height_);
  const auto pixels = static_cast<std::size_t>(last_x - first_x) * static_cast<std::size_t>(last_y - first_y);
  if (out.size + pixels > out.value.size()) return false;
  const float *value = plane(0), *dx = plane(1), *dy = plane(2), *dz = plane(3);
  for (std::int32_t y = first_y; y < last_y; ++y) {  // from the first to the last pixel of a row that is not too faint
    const std::int32_t row = (y - patch.row) * patch.width - patch.column;
    std::int32_t from = first_x, to = last_x;
    while (from < to && value[row + from] <= least) ++from;
    while (from < to && value[row + to - 1] <= least) --to;
    std::iota(out.pixel.begin() + static_cast<std::ptrdiff_t>(out.size),
              out.pixel.begin() + static_cast<std::ptrdiff_t>(out.size) + (to - from),
              static_cast<std::uint32_t>(y * width_ + from));
    std::copy(value + row + from, value + row + to, out.value.data() + out.size);
    std::copy(dx + row + from, dx + row + to, out.dx.data() + out.size);
    std::copy(dy + row + from, dy + row + to, out.dy.data() + out.size);
    std::copy(dz + row + from, dz + row + to, out.dz.data() + out.size);
    out.size += static_cast<std::size_t>(to - from);
  }
  return true;
}

// Sub-images that overlap: one entry a pixel.
bool ImageModel::merge(ParticleImage& image) noexcept {
  Patch box = patches_[0];
  std::int32_t right = 0, bottom = 0;
  for (const Patch& patch : patches()) {
    box.column = std::min(box.column, patch.column), right = std::max(right, patch.column + patch.width);
    box.row = std::min(box.row, patch.row), bottom = std::max(bottom, patch.row + patch.height);
  }
  return merge_pixels(image, {box.column, box.row, right - box.column, bottom - box.row, width_}, place_);
}

}  // namespace rptv
