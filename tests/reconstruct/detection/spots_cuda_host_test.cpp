// SPDX-License-Identifier: MIT
// The device's detections against SpotFinder's: the same in the same order, to the bit.
#include "reconstruct/detection/spots_cuda.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "reconstruct/detection/detect_stream_cuda.hpp"
#include "reconstruct/detection/lit_maxima_cuda.hpp"
#include "reconstruct/detection/spot_finder.hpp"
#include "tests/reconstruct/detection/painted_spots.hpp"
#include "tests/reconstruct/on_device.hpp"
#include "tests/reconstruct/random_image.hpp"

namespace rptv {
namespace {

using testing::OnDevice;
using testing::RandomImage;

struct Found {
  std::vector<double> x_px, y_px, sigma_px, grey, area_px;
  std::uint64_t all, merged, too_small;
  bool operator==(const Found&) const = default;
};

DarkPixels dark_of(const RandomImage& image, bool uniform) {
  if (uniform) return make_dark({12, 20, ""}, image.shape, {});
  RandomImage background = image;
  for (std::size_t i = 0; i < background.bytes.size(); ++i)
    background.bytes[i] = static_cast<std::byte>(i % background.shape.bytes_per_pixel == 0 ? i % 23 : 0);
  return make_dark({0, 20, ""}, image.shape, background.view());
}

Found by_cpu(const RandomImage& image, const DarkPixels& dark, const DetectorSettings& settings) {
  SpotFinder finder(settings, image.shape, best_instruction_set());
  Detections seen(static_cast<std::size_t>(settings.max_detections));
  DetectorCounts counts;
  if (image.shape.bytes_per_pixel == 1)
    finder.find<std::uint8_t>(image.view(), dark, seen, counts);
  else
    finder.find<std::uint16_t>(image.view(), dark, seen, counts);
  return {seen.x_px,     seen.y_px,       seen.sigma_px,
          seen.grey,     seen.area_px,    seen.size() + seen.overflow() - counts.refused_maxima,
          counts.merged, counts.too_small};
}

Found by_device(const RandomImage& image, const DarkPixels& dark, const DetectorSettings& settings, unsigned threads) {
  const auto capacity = static_cast<std::uint32_t>(settings.max_detections), most = 4 * capacity;
  const std::size_t known = dark.limit.uniform() ? 1 : image.shape.pixels();
  const OnDevice<std::byte> pixels(image.bytes);
  const OnDevice<float> mean({dark.mean.begin(), dark.mean.begin() + static_cast<std::ptrdiff_t>(known)});
  const auto limits = dark.limit.limits();
  const OnDevice<std::uint16_t> limit({limits.begin(), limits.begin() + static_cast<std::ptrdiff_t>(known)});
  const OnDevice<std::int32_t> integers(std::vector<std::int32_t>(4 * most, -1));
  const OnDevice<double> plateau(std::vector<double>(3 * most, -1)), out(std::vector<double>(5 * capacity, -1));
  const OnDevice<std::uint32_t> flags(std::vector<std::uint32_t>(3 * most, 9)), count({9}),
      row_start(std::vector<std::uint32_t>(image.shape.height_px + 1, 9));
  const OnDevice<float> centres(std::vector<float>(5 * most, -1));
  const OnDevice<CudaSpotCounts> counts({{0, 0}});
  const CudaImage view{pixels.data(), image.shape.width_px, image.shape.height_px, image.shape.bytes_per_pixel};
  const CudaDark known_dark{mean.data(), limit.data(), dark.limit.uniform()};
  const CudaMaxima maxima{integers.data(), integers.data() + most, row_start.data(), most};
  const CudaSpots spots{integers.data() + 2 * most, integers.data() + 3 * most, plateau.data(),
                        plateau.data() + most,      plateau.data() + 2 * most,  flags.data(),
                        flags.data() + most,        flags.data() + 2 * most,    centres.data(),
                        centres.data() + most,      centres.data() + 2 * most,  centres.data() + 3 * most,
                        centres.data() + 4 * most};
  double* value = out.data();
  const CudaDetections detections{
      value,        value + capacity, value + 2 * capacity, value + 3 * capacity, value + 4 * capacity,
      count.data(), capacity};
  CudaStream stream;
  EXPECT_TRUE(find_lit_maxima_cuda(view, known_dark, maxima, stream.handle(), threads) &&
              find_spots_cuda(view, known_dark, maxima, cuda_spot_settings(settings, image.shape), spots, detections,
                              counts.data(), stream.handle(), threads));
  const auto columns = out.read(stream);
  const CudaSpotCounts counted = counts.read(stream)[0];
  Found found{{}, {}, {}, {}, {}, count.read(stream)[0], counted.merged, counted.too_small};
  std::vector<double>* to[]{&found.x_px, &found.y_px, &found.sigma_px, &found.grey, &found.area_px};
  for (std::size_t k = 0; k < 5; ++k)
    to[k]->assign(
        columns.begin() + static_cast<std::ptrdiff_t>(k * capacity),
        columns.begin() + static_cast<std::ptrdiff_t>(k * capacity + std::min<std::size_t>(found.all, capacity)));
  return found;
}

RC_GTEST_PROP(SpotsCuda, are_those_of_the_cpu_by_every_method, ()) {
  const RandomImage image = testing::any_image(*rc::gen::element(9U, 40U));
  const DarkPixels dark = dark_of(image, *rc::gen::arbitrary<bool>());
  DetectorSettings settings;
  settings.method = *rc::gen::element<std::string>("gaussian", "three_point", "centroid");
  settings.overlap_sweeps = settings.method == "gaussian" ? 0 : *rc::gen::element(0, 6);
  settings.radius_px = *rc::gen::inRange(1, 4);
  settings.min_area_px = *rc::gen::inRange(1, 6);
  settings.split_sigmas = *rc::gen::element(0.0, 4.0, 40.0);
  settings.saturation_grey = *rc::gen::element(0, 200);
  settings.max_detections = *rc::gen::element(2, 3000);
  const Found expected = by_cpu(image, dark, settings);
  cuda_host::set_schedule_seed(*rc::gen::inRange(0U, 9U));
  RC_ASSERT(by_device(image, dark, settings, *rc::gen::element(32U, 96U, 256U)) == expected);
  RC_ASSERT(cuda_host::last_fault().empty());
}

RandomImage painted() {
  std::mt19937 random(4);
  const testing::Camera camera{{211, 157, 1}};
  const auto spots = testing::scatter_spots(camera.shape, 300, 0, 0, 1, 250, random);
  const testing::SpotImage image(camera, spots, random);
  const std::byte* first = image.view().data;
  return {camera.shape, {first, first + camera.shape.bytes()}};
}

TEST(SpotsCuda, of_an_image_of_particles_are_those_of_the_cpu_with_every_schedule) {
  const RandomImage image = painted();
  const DarkPixels dark = dark_of(image, true);
  for (const char* method : {"gaussian", "three_point", "centroid"}) {
    DetectorSettings settings;
    settings.method = method, settings.overlap_sweeps = 0, settings.max_detections = 1000;
    const Found expected = by_cpu(image, dark, settings);
    EXPECT_GT(expected.all, 200U);
    testing::with_every_schedule(
        [&](unsigned threads) { EXPECT_EQ(by_device(image, dark, settings, threads), expected) << method; });
  }
}

TEST(SpotsCuda, beyond_the_room_are_counted_and_the_first_are_kept) {
  const RandomImage image = painted();
  const DarkPixels dark = dark_of(image, true);
  DetectorSettings settings;
  settings.method = "three_point", settings.max_detections = 120;
  const Found expected = by_cpu(image, dark, settings);
  EXPECT_GT(expected.all, 120U);
  EXPECT_EQ(expected.x_px.size(), 120U);
  EXPECT_EQ(by_device(image, dark, settings, 96), expected);
}

}  // namespace
}  // namespace rptv
