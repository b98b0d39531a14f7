// SPDX-License-Identifier: MIT
// Running sums, lit pixels and their rays on the device, run on the CPU, against the CPU's own, bit for bit.
#include "reconstruct/light_field/pixels_to_rays_cuda.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <numeric>
#include <random>

#include "reconstruct/cuda_scan.hpp"
#include "reconstruct/light_field/pixels_to_rays.hpp"
#include "reconstruct/lit_pixels.hpp"
#include "tests/reconstruct/light_field/device_copies.hpp"
#include "tests/reconstruct/light_field/painted_image.hpp"

namespace rptv {
namespace {

using testing::from_device;
using testing::kBlockSizes;
using testing::kSchedules;
using testing::on_device;

TEST(CudaScan, gives_the_sums_before_each_value_and_of_all) {
  std::mt19937 random(3);
  for (const std::size_t size : {0U, 1U, 31U, 128U, 129U, 1000U, 5001U})
    for (const unsigned threads : kBlockSizes) {
      std::vector<std::uint32_t> values(size + 3), expected;
      for (auto& value : values) value = static_cast<std::uint32_t>(random() % 100);
      expected = values;
      std::exclusive_scan(values.begin(), values.end() - 3, expected.begin(), 0U);
      CudaStream stream;
      const auto array = on_device(stream, values);
      const DeviceArray<std::uint32_t> total(1);
      const auto live = on_device<std::uint32_t>(stream, {static_cast<std::uint32_t>(size)});
      ASSERT_TRUE(exclusive_scan_cuda(array.data(), size + 3, live.data(), total.data(), stream.handle(), threads));
      EXPECT_EQ(from_device(stream, array), expected) << size << ' ' << threads;
      EXPECT_EQ(from_device(stream, total)[0], std::accumulate(values.begin(), values.end() - 3, 0U));
    }
}

template <class Pixel>
void compare_lit_pixels(std::uint32_t width, std::uint32_t height, bool uniform, std::size_t capacity) {
  const ImageShape shape{width, height, sizeof(Pixel)};
  std::mt19937 random(width);
  std::vector<Pixel> pixels(shape.pixels()), dark(shape.pixels());
  for (auto& grey : dark) grey = static_cast<Pixel>(random() % 150);
  for (auto& grey : pixels) grey = static_cast<Pixel>(random() % 9 == 0 ? random() : random() % 5);
  const ImageView image{reinterpret_cast<const std::byte*>(pixels.data()), shape};
  const DarkLimit limit = uniform ? DarkLimit(shape, 40, 10.5)
                                  : DarkLimit(ImageView{reinterpret_cast<const std::byte*>(dark.data()), shape}, 10.5);
  std::vector<std::uint32_t> expected(capacity);
  const std::size_t found = find_lit_pixels(image, limit, expected);
  CudaStream stream;
  const auto on = on_device(stream, pixels);
  const auto limits = on_device(stream, std::vector<std::uint16_t>(limit.limits().begin(), limit.limits().end()));
  for (const unsigned threads : kBlockSizes) {
    cuda_host::set_schedule_seed(threads);
    const DeviceArray<std::uint32_t> lit(capacity), size(1), runs((shape.pixels() + 1023) / 1024);
    ASSERT_TRUE(find_lit_pixels_cuda({on.data(), width, height, sizeof(Pixel)}, {nullptr, limits.data(), uniform},
                                     {lit.data(), size.data(), runs.data(), static_cast<std::uint32_t>(capacity)},
                                     stream.handle(), threads));
    ASSERT_EQ(from_device(stream, size)[0], found);
    const std::size_t kept = std::min(found, capacity);
    EXPECT_EQ(from_device(stream, lit, kept),
              std::vector<std::uint32_t>(expected.begin(), expected.begin() + static_cast<std::ptrdiff_t>(kept)));
  }
}

TEST(CudaLitPixels, are_those_of_the_cpu_in_their_order_and_counted_where_there_is_no_room) {
  for (const std::uint32_t width : {1U, 63U, 65U, 341U})
    for (const std::size_t capacity : {std::size_t{20}, std::size_t{100000}}) {
      compare_lit_pixels<std::uint8_t>(width, 7, false, capacity);
      compare_lit_pixels<std::uint16_t>(width, 31, true, capacity);
    }
}

/// PixelsToRays of a camera on both sides.
class BothSides {
 public:
  BothSides(const LightFieldCalibration& camera, std::size_t hypotheses)
      : lattice_(camera), pixels_to_rays_(camera, lattice_, hypotheses) {}

  void compare(const std::vector<std::uint32_t>& lit, std::size_t capacity, unsigned threads) {
    Rays expected(capacity, lattice_.size());
    const std::size_t refused = pixels_to_rays_.convert(lit, expected);
    std::vector<float> centres;
    for (std::uint32_t l = 0; l < lattice_.size(); ++l)
      for (const float at : lattice_.centre_mm(l)) centres.push_back(at);
    const auto table = on_device(
        stream_, std::vector<std::uint32_t>(pixels_to_rays_.lenslets().begin(), pixels_to_rays_.lenslets().end()));
    const auto centre = on_device(stream_, centres);
    const auto lit_size = on_device<std::uint32_t>(stream_, {static_cast<std::uint32_t>(lit.size()) + 3});  // no room
    const auto lit_pixels = on_device(stream_, lit);
    const DeviceArray<std::uint32_t> first_ray(lit.size()), place(capacity), sort_pixel(capacity),
        sort_lenslet(capacity), filled(lattice_.size()), pixel(capacity), same(capacity), first(lattice_.size() + 1),
        size(1), pixels(1);
    const DeviceArray<Ray> ray(capacity);
    ASSERT_TRUE(
        pixels_to_rays_cuda({lit_pixels.data(), lit_size.data(), nullptr, static_cast<std::uint32_t>(lit.size())},
                            {table.data(), centre.data(), pixels_to_rays_.optics(),
                             static_cast<std::uint32_t>(pixels_to_rays_.hypotheses()), pixels_to_rays_.width_px()},
                            {first_ray.data(), place.data(), sort_pixel.data(), sort_lenslet.data(), filled.data()},
                            {ray.data(), pixel.data(), same.data(), first.data(), size.data(), pixels.data(),
                             static_cast<std::uint32_t>(capacity), static_cast<std::uint32_t>(lattice_.size())},
                            stream_.handle(), threads));
    ASSERT_EQ(from_device(stream_, size)[0], expected.size);
    ASSERT_EQ(from_device(stream_, pixels)[0], expected.pixels);
    EXPECT_EQ(lit.size() - expected.pixels, refused);
    const auto rays = from_device(stream_, ray, expected.size);
    EXPECT_TRUE(rays.empty() || std::memcmp(rays.data(), expected.ray.data(), expected.size * sizeof(Ray)) == 0);
    EXPECT_EQ(from_device(stream_, first), expected.first_of_lenslet);
    expected.pixel.resize(expected.size), expected.same_pixel.resize(expected.size);
    EXPECT_EQ(from_device(stream_, pixel, expected.size), expected.pixel);
    EXPECT_EQ(from_device(stream_, same, expected.size), expected.same_pixel);
  }

 private:
  CudaStream stream_;
  LensletLattice lattice_;
  PixelsToRays pixels_to_rays_;
};

std::vector<std::uint32_t> every(std::uint32_t pixels, unsigned one_in) {
  std::mt19937 random(5);
  std::vector<std::uint32_t> lit;
  for (std::uint32_t i = 0; i < pixels; ++i)
    if (random() % one_in == 0) lit.push_back(i);
  return lit;
}

TEST(CudaPixelsToRays, gives_the_rays_of_the_cpu_in_their_order) {
  auto camera = testing::small_camera(120, 90);
  camera.mask = {0, 0, 1, 1, {lenslet_reason::kBrightness}};  // pixels without a ray
  BothSides sides(camera, 1);
  for (const auto seed : kSchedules) {
    cuda_host::set_schedule_seed(seed);
    for (const unsigned threads : kBlockSizes) sides.compare(every(120 * 90, 5), 10000, threads);
  }
}

TEST(CudaPixelsToRays, gives_one_ray_per_hypothesis_and_leaves_out_what_the_cpu_leaves_out) {
  auto camera = testing::small_camera(121, 90);
  camera.lens.image_f_number = 16;
  BothSides sides(camera, 4);
  const auto lit = every(121 * 90, 4);
  for (const std::size_t capacity :
       {std::size_t{0}, std::size_t{3}, std::size_t{1001}, std::size_t{1002}, 4 * lit.size()})
    sides.compare(lit, capacity, 96);
}

TEST(CudaPixelsToRays, gives_no_rays_without_light) {
  BothSides(testing::small_camera(40, 30), 1).compare({}, 100, 96);
}

}  // namespace
}  // namespace rptv
