// SPDX-License-Identifier: MIT
// The device's search for lit maxima against the CPU's: the same ones in the same order.
#include "reconstruct/detection/lit_maxima_cuda.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "reconstruct/detection/lit_maxima.hpp"
#include "tests/reconstruct/on_device.hpp"
#include "tests/reconstruct/random_image.hpp"

namespace rptv {
namespace {

using testing::OnDevice;
using testing::RandomImage;

struct Found {
  std::vector<PixelIndex> maxima;
  std::vector<std::uint32_t> row_start;
};

Found by_device(const RandomImage& image, const DarkLimit& limit, std::uint32_t capacity, unsigned threads) {
  const OnDevice<std::byte> pixels(image.bytes);
  const auto limits = limit.limits();
  const OnDevice<std::uint16_t> dark(
      std::vector<std::uint16_t>(limits.begin(), limits.begin() + (limit.uniform() ? 1 : std::ssize(limits))));
  const OnDevice<std::int32_t> x(std::vector<std::int32_t>(capacity, -1)), y(std::vector<std::int32_t>(capacity, -1));
  const OnDevice<std::uint32_t> row_start(std::vector<std::uint32_t>(image.shape.height_px + 1, 12345));
  CudaStream stream;
  EXPECT_TRUE(
      find_lit_maxima_cuda({pixels.data(), image.shape.width_px, image.shape.height_px, image.shape.bytes_per_pixel},
                           {nullptr, dark.data(), limit.uniform()}, {x.data(), y.data(), row_start.data(), capacity},
                           stream.handle(), threads));
  Found found{{}, row_start.read(stream)};
  const auto columns = x.read(stream), rows = y.read(stream);
  for (std::size_t i = 0; i < std::min(capacity, found.row_start.back()); ++i)
    found.maxima.push_back({columns[i], rows[i]});
  return found;
}

RC_GTEST_PROP(LitMaximaCuda, are_those_of_the_cpu_in_raster_order, ()) {
  const RandomImage image = testing::any_image(*rc::gen::element(3U, 35U, 100U));
  const DarkLimit limit = testing::any_limit(image);
  const auto capacity = *rc::gen::element(0U, 3U, 20000U);
  std::vector<PixelIndex> expected(capacity);
  const std::size_t all = find_lit_maxima(image.view(), limit, expected);
  expected.resize(std::min<std::size_t>(all, capacity));
  cuda_host::set_schedule_seed(*rc::gen::inRange(0U, 9U));
  const Found found = by_device(image, limit, capacity, *rc::gen::element(32U, 96U, 256U));
  RC_ASSERT(found.row_start.front() == 0U);
  RC_ASSERT(found.row_start.back() == all);  // those without room, too
  RC_ASSERT(found.maxima == expected);
  RC_ASSERT(cuda_host::last_fault().empty());
}

TEST(LitMaximaCuda, say_where_each_row_begins_with_every_schedule) {
  RandomImage image{{129, 301, 2}, std::vector<std::byte>(129 * 301 * 2)};
  std::mt19937 random(1);
  for (auto& byte : image.bytes) byte = static_cast<std::byte>(random() % 256);
  const DarkLimit limit(image.shape, 0, 1000);
  std::vector<PixelIndex> expected(image.shape.pixels());
  expected.resize(find_lit_maxima(image.view(), limit, expected));
  testing::with_every_schedule([&](unsigned threads) {
    const Found found = by_device(image, limit, 20000, threads);
    ASSERT_EQ(found.maxima, expected);
    for (std::int32_t y = 0; y < 301; ++y)
      for (std::uint32_t i = found.row_start[static_cast<std::size_t>(y)];
           i < found.row_start[static_cast<std::size_t>(y) + 1]; ++i)
        EXPECT_EQ(found.maxima[i].y, y);
  });
}

}  // namespace
}  // namespace rptv
