// SPDX-License-Identifier: MIT
// Memory of one camera's frame on the device, and the order of the kernels.
#include "reconstruct/detection/detect_stream_cuda.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "core/error.hpp"
#include "reconstruct/detection/lit_maxima_cuda.hpp"
#include "reconstruct/detection/separate_spots.hpp"
#include "reconstruct/detection/spot_finder.hpp"

namespace rptv {

namespace {

constexpr std::size_t kColumns = 5;  // of a detection

template <class T>
bool put(CudaStream& stream, const DeviceArray<T>& to, const T* from) {
  return stream.upload(to.data(), from, to.size() * sizeof(T));
}

}  // namespace

CudaSpotSettings cuda_spot_settings(const DetectorSettings& settings, const ImageShape& shape) {
  const auto radius = static_cast<std::int32_t>(settings.radius_px);
  const double highest =
      shape.bytes_per_pixel == 1 ? std::numeric_limits<std::uint8_t>::max() : std::numeric_limits<std::uint16_t>::max();
  return {spot_options(settings),
          static_cast<float>(settings.saturation_grey > 0 ? settings.saturation_grey : highest),
          static_cast<float>(settings.split_sigmas),
          merge_reach(radius),
          settings.overlap_sweeps > 0 ? crowd_reach(radius) : merge_reach(radius),
          static_cast<std::uint32_t>(settings.min_area_px)};
}

DetectStream::DetectStream(const DetectorSettings& settings, const ImageShape& shape, const DarkPixels& dark,
                           unsigned threads_per_block)
    : settings_(settings),
      shape_(shape),
      threads_(threads_per_block),
      uniform_(dark.limit.uniform()),
      capacity_(static_cast<std::size_t>(settings.max_detections)),
      most_maxima_(kMaximaPerDetection * capacity_),
      pixels_(shape.pixels()),
      limit_(uniform_ ? 1 : shape.pixels()),
      mean_(limit_.size()),
      centres_(5 * most_maxima_),
      columns_and_rows_(4 * most_maxima_),
      row_start_(shape.height_px + std::size_t{1}),
      flags_(3 * most_maxima_),
      count_(1),
      plateaus_(3 * most_maxima_),
      found_(kColumns * capacity_),
      spot_counts_(1),
      image_(shape.pixels()),
      columns_(kColumns * capacity_),
      totals_(1) {
  if (const std::string setting = only_on_cpu(settings); !setting.empty())
    throw Error(ExitCode::unavailable,
                "CUDA: the device does not do " + setting + ", or reconstruction.backend = \"cpu\"");
  if (!put(stream_, limit_, dark.limit.limits().data()) || !put(stream_, mean_, dark.mean.data()) ||
      !stream_.synchronize())
    throw Error(ExitCode::unavailable,
                fmt::format("CUDA: the background does not reach the device: {}; take reconstruction.backend = \"cpu\"",
                            take_cuda_error()));
}

CudaSpots DetectStream::spots() const noexcept {
  const std::size_t most = most_maxima_;
  std::int32_t* middle = columns_and_rows_.data() + 2 * most;
  double* plateau = plateaus_.data();
  std::uint32_t* flag = flags_.data();
  float* centre = centres_.data();
  return {middle,           middle + most,   plateau, plateau + most, plateau + 2 * most, flag,
          flag + most,      flag + 2 * most, centre,  centre + most,  centre + 2 * most,  centre + 3 * most,
          centre + 4 * most};
}

void DetectStream::submit(const ImageView& image) noexcept {
  state_ = State::refused;
  if (image.data == nullptr || !image.shape.has_size_of(shape_)) return;
  std::memcpy(image_.data(), image.data, image.shape.bytes());
  state_ = queue(image) ? State::queued : State::failed;
}

bool DetectStream::queue(const ImageView& image) noexcept {
  const CudaImage on_device{pixels_.data(), shape_.width_px, shape_.height_px, image.shape.bytes_per_pixel};
  const CudaDark dark{mean_.data(), limit_.data(), uniform_};
  const CudaMaxima maxima{columns_and_rows_.data(), columns_and_rows_.data() + most_maxima_, row_start_.data(),
                          static_cast<std::uint32_t>(most_maxima_)};
  double* found = found_.data();
  const CudaDetections out{found,
                           found + capacity_,
                           found + 2 * capacity_,
                           found + 3 * capacity_,
                           found + 4 * capacity_,
                           count_.data(),
                           static_cast<std::uint32_t>(capacity_)};
  Totals& totals = totals_[0];
  return stream_.upload(pixels_.data(), image_.data(), image.shape.bytes()) &&
         stream_.fill(spot_counts_.data(), 0, sizeof(CudaSpotCounts)) &&
         find_lit_maxima_cuda(on_device, dark, maxima, stream_.handle(), threads_) &&
         find_spots_cuda(on_device, dark, maxima, cuda_spot_settings(settings_, image.shape), spots(), out,
                         spot_counts_.data(), stream_.handle(), threads_) &&
         stream_.download(&totals.maxima, row_start_.data() + shape_.height_px, sizeof totals.maxima) &&
         stream_.download(&totals.detections, count_.data(), sizeof totals.detections) &&
         stream_.download(&totals.spots, spot_counts_.data(), sizeof totals.spots);
}

void DetectStream::collect(Detections& out) noexcept {
  out.clear();
  const State state = std::exchange(state_, State::idle);
  if (state == State::idle) return;
  if (state == State::refused) {
    ++counts_.refused_frames;
    return;
  }
  const Totals& totals = totals_[0];
  bool done = state == State::queued && stream_.synchronize();
  const std::size_t count = done ? std::min<std::size_t>(totals.detections, capacity_) : 0;
  for (std::size_t k = 0; k < kColumns; ++k)
    done = done &&
           stream_.download(columns_.data() + k * capacity_, found_.data() + k * capacity_, count * sizeof(double));
  if (!done || !stream_.synchronize()) {
    ++failed_;
    return;
  }
  const std::size_t refused = totals.maxima > most_maxima_ ? totals.maxima - most_maxima_ : 0;
  counts_.refused_maxima += refused, counts_.merged += totals.spots.merged, counts_.too_small += totals.spots.too_small;
  ++counts_.frames;
  out.refuse(refused + totals.detections - count);
  const double* column = columns_.data();
  for (std::size_t i = 0; i < count; ++i)
    out.push({column[i], column[capacity_ + i], column[2 * capacity_ + i], column[3 * capacity_ + i],
              column[4 * capacity_ + i], 0, 0, 0});
}

}  // namespace rptv
