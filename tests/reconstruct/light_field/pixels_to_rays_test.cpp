// SPDX-License-Identifier: MIT
// From grey values to rays: thresholds against a plain loop, rays against the geometry that painted the image.
#include "reconstruct/light_field/pixels_to_rays.hpp"

#include <gtest/gtest.h>

#include <random>

#include "reconstruct/lit_pixels.hpp"
#include "tests/core/instruction_sets.hpp"
#include "tests/reconstruct/light_field/painted_image.hpp"

namespace rptv {
namespace {

using testing::PaintedImage;
using testing::sets_here;
using testing::small_camera;

template <class Pixel>
void compare_with_plain_loop(const ImageView& view, const std::vector<Pixel>& dark, const DarkLimit& limit) {
  const auto* pixels = reinterpret_cast<const Pixel*>(view.data);
  std::vector<std::uint32_t> expected, found;
  for (std::size_t i = 0; i < dark.size(); ++i)
    if (pixels[i] > dark[i] + 10.5) expected.push_back(static_cast<std::uint32_t>(i));
  for (const auto set : sets_here()) {
    found.assign(dark.size(), 0);
    found.resize(find_lit_pixels(view, limit, found, set));
    EXPECT_EQ(found, expected) << name_of(set);
    const std::size_t room = expected.size() / 2;
    found.assign(room, 0);
    EXPECT_EQ(find_lit_pixels(view, limit, found, set), expected.size()) << name_of(set);
    EXPECT_TRUE(std::equal(found.begin(), found.end(), expected.begin())) << name_of(set);
  }
}

template <class Pixel>
void compare_with_plain_loop(std::size_t width, unsigned highest) {
  const ImageShape shape{static_cast<std::uint32_t>(width), 7, sizeof(Pixel)};
  std::mt19937 random(static_cast<unsigned>(width));
  std::uniform_int_distribution<unsigned> grey(0, highest), rare(0, 30);
  std::vector<Pixel> image(shape.pixels()), dark(shape.pixels());
  for (auto& p : dark) p = static_cast<Pixel>(grey(random));
  for (auto& p : image) p = static_cast<Pixel>(rare(random) == 0 ? grey(random) : 0);
  const ImageView view{reinterpret_cast<const std::byte*>(image.data()), shape};
  compare_with_plain_loop(view, dark, DarkLimit({reinterpret_cast<const std::byte*>(dark.data()), shape}, 10.5));
  dark.assign(dark.size(), static_cast<Pixel>(highest / 2));
  compare_with_plain_loop(view, dark, DarkLimit(shape, highest / 2, 10.5));
}

TEST(LitPixels, are_those_above_background_and_threshold) {
  for (const std::size_t width : {1U, 9U, 63U, 64U, 65U, 200U, 1001U}) {
    compare_with_plain_loop<std::uint8_t>(width, 255);
    compare_with_plain_loop<std::uint16_t>(width, 4095);
    compare_with_plain_loop<std::uint16_t>(width, 65535);
  }
}

TEST(LitPixels, counts_what_does_not_fit) {
  const ImageShape shape{100, 3, 1};
  const std::vector<std::uint8_t> image(300, 50);
  std::vector<std::uint32_t> found(20);
  const ImageView view{reinterpret_cast<const std::byte*>(image.data()), shape};
  EXPECT_EQ(find_lit_pixels(view, DarkLimit(shape, 20, 20), found), 300U);
  EXPECT_EQ(found.back(), 19U);
  EXPECT_EQ(find_lit_pixels(view, DarkLimit(shape, 30, 20), found), 0U);
}

TEST(PixelsToRays, rays_of_a_painted_particle_pass_it_within_half_a_cell) {
  const auto camera = small_camera();
  const LensletLattice lattice(camera);
  const PixelsToRays pixels_to_rays(camera, lattice, 1);
  for (const testing::ImageParticle p : {testing::ImageParticle{0.4, -0.3, -18}, {0.1, 0.2, 9}, {-0.6, 0.5, -2}}) {
    PaintedImage image(camera);
    const int lit_count = image.paint(p, 0);
    ASSERT_GT(lit_count, 80);
    std::vector<std::uint32_t> lit(image.pixels().size());
    lit.resize(find_lit_pixels(image.view(), DarkLimit(image.view().shape, 0, 10), lit));
    Rays rays(10000, lattice.size());
    ASSERT_EQ(pixels_to_rays.convert(lit, rays), 0U);
    ASSERT_EQ(rays.size, static_cast<std::size_t>(lit_count));
    for (const Ray& ray : rays.all()) {
      EXPECT_LE(std::abs(ray.centre_x + ray.slope_x * p.z - p.x), 0.0629);  // half a pitch, turned by 0.19 degrees
      EXPECT_LE(std::abs(ray.centre_y + ray.slope_y * p.z - p.y), 0.0629);
    }
  }
}

TEST(PixelsToRays, sorts_rays_by_lenslet_and_keeps_their_pixels) {
  const auto camera = small_camera(120, 90);
  const LensletLattice lattice(camera);
  const PixelsToRays pixels_to_rays(camera, lattice, 1);
  std::vector<std::uint32_t> lit;
  std::mt19937 random(5);
  for (std::uint32_t i = 0; i < 120 * 90; ++i)
    if (random() % 5 == 0) lit.push_back(i);
  Rays rays(lit.size(), lattice.size());
  for (int frame = 0; frame < 2; ++frame) {  // the second time over used memory
    ASSERT_EQ(pixels_to_rays.convert(lit, rays), 0U);
    ASSERT_EQ(rays.size, lit.size());
    std::vector<char> seen(lit.size());
    for (std::uint32_t l = 0; l < lattice.size(); ++l)
      for (auto i = rays.first_of_lenslet[l]; i < rays.first_of_lenslet[l + 1]; ++i) {
        EXPECT_EQ(rays.ray[i].centre_x, lattice.centre_mm(l)[0]);
        EXPECT_EQ(rays.ray[i].centre_y, lattice.centre_mm(l)[1]);
        const auto pixel = lit[rays.pixel[i]];
        EXPECT_NEAR(rays.ray[i].centre_x - 3.75F * rays.ray[i].slope_x, (pixel % 120 - 59.5) * 9e-3, 1e-6);
        EXPECT_NEAR(rays.ray[i].centre_y - 3.75F * rays.ray[i].slope_y, (pixel / 120 - 44.5) * 9e-3, 1e-6);
        EXPECT_EQ(seen[rays.pixel[i]]++, 0);
      }
    EXPECT_EQ(rays.first_of_lenslet.back(), rays.size);
  }
}

TEST(PixelsToRays, gives_one_ray_per_hypothesis_where_sub_images_overlap) {
  auto camera = small_camera(120, 90);
  camera.lens.image_f_number = 16;
  const LensletLattice lattice(camera);
  const PixelsToRays pixels_to_rays(camera, lattice, 4);
  std::vector<std::uint32_t> lit(120 * 90);
  for (std::uint32_t i = 0; i < lit.size(); ++i) lit[i] = i;
  Rays rays(4 * lit.size(), lattice.size());
  ASSERT_EQ(pixels_to_rays.convert(lit, rays), 0U);
  std::vector<int> of_pixel(lit.size());
  for (std::size_t i = 0; i < rays.size; ++i) ++of_pixel[rays.pixel[i]];
  EXPECT_EQ(*std::min_element(of_pixel.begin(), of_pixel.end()), 1);
  EXPECT_EQ(*std::max_element(of_pixel.begin(), of_pixel.end()), 4);
  for (const Ray& ray : rays.all()) {  // every slope is one that the pupil sends through that lenslet
    const double chief_x = -ray.centre_x / 84.82, chief_y = -ray.centre_y / 84.82;
    EXPECT_LE(std::hypot(ray.slope_x - chief_x, ray.slope_y - chief_y), 0.5 / 16 + 0.0064 / 3.75 + 1e-6);
  }
}

TEST(PixelsToRays, leaves_out_and_counts_pixels_beyond_its_room) {
  const auto camera = small_camera(120, 90);
  const LensletLattice lattice(camera);
  const PixelsToRays pixels_to_rays(camera, lattice, 1);
  std::vector<std::uint32_t> lit(500);
  for (std::uint32_t i = 0; i < lit.size(); ++i) lit[i] = 7 * i;
  Rays rays(300, lattice.size());
  EXPECT_EQ(pixels_to_rays.convert(lit, rays), 200U);
  EXPECT_EQ(rays.size, 300U);
  EXPECT_EQ(rays.pixels, 300U);
}

TEST(PixelsToRays, pixels_of_a_masked_lenslet_give_no_ray) {
  auto camera = small_camera(120, 90);
  std::vector<std::uint32_t> lit(120 * 90);
  for (std::uint32_t i = 0; i < lit.size(); ++i) lit[i] = i;
  const LensletLattice all(camera);
  camera.arrays.ray = {0, 0, 1, 1, {lenslet_reason::kBrightness}};
  const LensletLattice masked(camera);
  Rays before(lit.size(), all.size()), after(lit.size(), masked.size());
  PixelsToRays(camera, all, 1).convert(lit, before);
  const PixelsToRays pixels_to_rays(camera, masked, 1);
  ASSERT_EQ(pixels_to_rays.convert(lit, after), 0U);
  EXPECT_NEAR(static_cast<double>(before.size - after.size), 14.5 * 14.5, 20);  // one cell
  for (std::uint32_t l = 0; l < masked.size(); ++l)
    EXPECT_TRUE(masked.masked(l) == 0 || after.first_of_lenslet[l] == after.first_of_lenslet[l + 1]);
}

}  // namespace
}  // namespace rptv
