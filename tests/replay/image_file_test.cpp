// SPDX-License-Identifier: MIT
// Every form of image file that replay reads gives back the exact pixels; every other is refused in one line.
#include "replay/image_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>
#include <tiffio.h>

#include "tests/replay/image_maker.hpp"

namespace rptv::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(Png, gives_back_the_pixels_that_were_written) {
  const TemporaryFolder folder;
  for (const std::uint32_t bytes : {1U, 2U}) {
    const Picture picture = make_picture(37, 23, bytes, bytes);
    write_png(folder / "a.png", picture.view());
    EXPECT_EQ(read_picture(folder / "a.png"), picture);
  }
}

TEST(Png, keeps_the_significant_bits) {
  const TemporaryFolder folder;
  write_png(folder / "a.png", make_picture(8, 8, 2, 1).view(), 12);
  EXPECT_EQ(open_image(folder / "a.png")->header(0).significant_bits, 12U);
  write_png(folder / "b.png", make_picture(8, 8, 2, 1).view());
  EXPECT_EQ(open_image(folder / "b.png")->header(0).significant_bits, 16U);
}

TEST(Png, stores_16_bit_values_big_endian_as_the_format_says) {
  const TemporaryFolder folder;
  Picture picture{{1, 1, 2}, std::vector<std::byte>(2)};
  *reinterpret_cast<std::uint16_t*>(picture.pixels.data()) = 0x1234;
  write_interlaced_png(folder / "a.png", picture);  // written by libpng from a known host value
  const Picture read = read_picture(folder / "a.png");
  EXPECT_EQ(*read.view().as_u16(), 0x1234);
}

TEST(Png, reads_interlaced_images) {
  const TemporaryFolder folder;
  for (const std::uint32_t bytes : {1U, 2U}) {
    const Picture picture = make_picture(41, 19, bytes, 7);
    write_interlaced_png(folder / "a.png", picture);
    EXPECT_EQ(read_picture(folder / "a.png"), picture);
  }
}

TEST(Png, can_be_decoded_again_from_the_same_reader) {
  const TemporaryFolder folder;
  const Picture picture = make_picture(30, 20, 2, 3);
  write_png(folder / "a.png", picture.view());
  const auto reader = open_image(folder / "a.png");
  for (int i = 0; i < 3; ++i) {
    std::vector<std::byte> pixels(picture.shape.bytes());
    reader->decode(0, pixels);
    EXPECT_EQ(pixels, picture.pixels);
  }
}

TEST(Png, refuses_colour_palette_transparency_and_odd_depths) {
  const TemporaryFolder folder;
  const auto file = folder / "odd.png";
  for (const int colour : {PNG_COLOR_TYPE_RGB, PNG_COLOR_TYPE_RGB_ALPHA, PNG_COLOR_TYPE_GRAY_ALPHA}) {
    write_odd_png(file, colour, 8);
    const auto [code, text] = error_of([&] { open_image(file); });
    EXPECT_EQ(code, ExitCode::bad_data);
    EXPECT_THAT(text, AllOf(HasSubstr(file.string()), HasSubstr("colour"), HasSubstr("convert"), Not(HasSubstr("\n"))));
  }
  write_odd_png(file, PNG_COLOR_TYPE_PALETTE, 8);
  EXPECT_THAT(error_of([&] { open_image(file); }).second, HasSubstr("palette"));
  write_odd_png(file, PNG_COLOR_TYPE_GRAY, 4);
  EXPECT_THAT(error_of([&] { open_image(file); }).second, HasSubstr("4 bits per pixel"));
}

TEST(Png, cut_anywhere_is_refused_when_it_is_opened) {
  const TemporaryFolder folder;
  const auto file = folder / "a.png";
  write_png(file, make_picture(64, 48, 2, 5).view());
  const auto whole = std::filesystem::file_size(file);
  for (const std::uintmax_t length : {std::uintmax_t{8}, std::uintmax_t{20}, std::uintmax_t{40}, whole / 2, whole - 13,
                                      whole - 12, whole - 5, whole - 1}) {
    write_png(file, make_picture(64, 48, 2, 5).view());
    std::filesystem::resize_file(file, length);
    const auto [code, text] = error_of([&] { open_image(file); });
    EXPECT_EQ(code, ExitCode::bad_data) << length;
    EXPECT_THAT(text, AllOf(HasSubstr(file.string()), HasSubstr("truncated"), HasSubstr("copy the file again")));
  }
}

TEST(Png, cut_after_it_was_opened_is_an_error_of_the_decoder) {
  const TemporaryFolder folder;
  const auto file = folder / "a.png";
  const Picture picture = make_picture(256, 256, 2, 5);
  write_png(file, picture.view());
  const auto reader = open_image(file);
  cut_short(file, 0.5);
  std::vector<std::byte> pixels(picture.shape.bytes());
  const auto [code, text] = error_of([&] { reader->decode(0, pixels); });
  EXPECT_EQ(code, ExitCode::bad_data);
  EXPECT_THAT(text, AllOf(HasSubstr(file.string()), HasSubstr("truncated or damaged")));
}

TEST(Png, with_flipped_bits_is_an_error_of_the_decoder) {
  const TemporaryFolder folder;
  const auto file = folder / "a.png";
  const Picture picture = make_picture(64, 64, 1, 5);
  write_png(file, picture.view());
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  stream.seekp(static_cast<std::streamoff>(std::filesystem::file_size(file) / 2));
  stream << "damage";
  stream.close();
  const auto reader = open_image(file);
  std::vector<std::byte> pixels(picture.shape.bytes());
  EXPECT_EQ(error_of([&] { reader->decode(0, pixels); }).first, ExitCode::bad_data);
}

TEST(Png, that_cannot_be_written_is_an_error_and_leaves_nothing) {
  const TemporaryFolder folder;
  EXPECT_EQ(error_of([&] { write_png(folder / "no/such/a.png", make_picture(8, 8, 1, 1).view()); }).first,
            ExitCode::no_input);
  EXPECT_EQ(error_of([&] { write_png("/dev/full", make_picture(64, 64, 2, 1).view()); }).first, ExitCode::io);
  EXPECT_EQ(error_of([&] { write_png(folder / "b.png", {nullptr, {0, 0, 1}}); }).first, ExitCode::internal);
  EXPECT_FALSE(std::filesystem::exists(folder / "b.png"));
}

struct NamedForm {
  const char* name;
  TiffForm form;
};

class TiffForms : public ::testing::TestWithParam<NamedForm> {};

TEST_P(TiffForms, gives_back_the_exact_pixels_of_every_page) {
  const TemporaryFolder folder;
  for (const std::uint32_t bytes : {1U, 2U}) {
    const std::vector<Picture> pages{make_picture(50, 33, bytes, 1), make_picture(50, 33, bytes, 2),
                                     make_picture(50, 33, bytes, 3)};
    write_tiff(folder / "a.tif", pages, GetParam().form);
    const auto reader = open_image(folder / "a.tif");
    ASSERT_EQ(reader->pages(), 3U);
    for (const std::size_t page : {2U, 0U, 1U, 1U}) {
      EXPECT_EQ(reader->header(page).shape, pages[page].shape);
      std::vector<std::byte> pixels(pages[page].shape.bytes());
      reader->decode(page, pixels);
      EXPECT_EQ(pixels, pages[page].pixels) << "page " << page << ", " << bytes << " bytes";
    }
  }
}

TiffForm form(void (*change)(TiffForm&)) {
  TiffForm made;
  change(made);
  return made;
}

INSTANTIATE_TEST_SUITE_P(
    All, TiffForms,
    ::testing::Values(NamedForm{"little_endian", form([](TiffForm&) {})},
                      NamedForm{"big_endian", form([](TiffForm& f) { f.big_endian = true; })},
                      NamedForm{"big_tiff", form([](TiffForm& f) { f.big_tiff = true; })},
                      NamedForm{"big_tiff_big_endian", form([](TiffForm& f) { f.big_tiff = f.big_endian = true; })},
                      NamedForm{"tiles", form([](TiffForm& f) { f.tile = 16; })},
                      NamedForm{"tiles_larger_than_the_image", form([](TiffForm& f) { f.tile = 64; })},
                      NamedForm{"big_endian_tiles", form([](TiffForm& f) { f.tile = 32, f.big_endian = true; })},
                      NamedForm{"one_strip", form([](TiffForm& f) { f.rows_per_strip = 1000; })},
                      NamedForm{"lzw", form([](TiffForm& f) { f.compression = COMPRESSION_LZW; })},
                      NamedForm{"deflate", form([](TiffForm& f) { f.compression = COMPRESSION_ADOBE_DEFLATE; })},
                      NamedForm{"deflate_tiles_big_endian", form([](TiffForm& f) {
                                  f.compression = COMPRESSION_ADOBE_DEFLATE, f.tile = 16, f.big_endian = true;
                                })},
                      NamedForm{"packbits", form([](TiffForm& f) { f.compression = COMPRESSION_PACKBITS; })},
                      NamedForm{"thumbnails_between_pages", form([](TiffForm& f) { f.with_thumbnails = true; })}),
    [](const auto& tested) { return tested.param.name; });

TEST(Tiff, with_white_as_zero_is_turned_round) {
  const TemporaryFolder folder;
  Picture picture{{2, 1, 2}, std::vector<std::byte>(4)};
  auto* values = reinterpret_cast<std::uint16_t*>(picture.pixels.data());
  values[0] = 65535;
  values[1] = 1000;
  TiffForm inverted;
  inverted.photometric = PHOTOMETRIC_MINISWHITE;
  write_tiff(folder / "a.tif", {picture}, inverted);
  const Picture read = read_picture(folder / "a.tif");
  EXPECT_EQ(read.view().as_u16()[0], 0);
  EXPECT_EQ(read.view().as_u16()[1], 64535);
}

TEST(Tiff, refuses_what_is_not_plain_grey) {
  const TemporaryFolder folder;
  const auto file = folder / "odd.tif";
  const auto refusal = [&](TiffForm odd) {
    write_tiff(file, {make_picture(16, 12, 2, 1)}, odd);
    const auto [code, text] = error_of([&] { open_image(file); });
    EXPECT_EQ(code, ExitCode::bad_data);
    EXPECT_THAT(text, AllOf(HasSubstr(file.string()), Not(HasSubstr("\n"))));
    return text;
  };
  EXPECT_THAT(refusal(form([](TiffForm& f) { f.samples = 3, f.photometric = PHOTOMETRIC_RGB; })),
              HasSubstr("3 channels"));
  EXPECT_THAT(refusal(form([](TiffForm& f) { f.sample_format = SAMPLEFORMAT_INT; })), HasSubstr("signed"));
  EXPECT_THAT(refusal(form([](TiffForm& f) { f.orientation = ORIENTATION_BOTLEFT; })), HasSubstr("turned"));
}

TEST(Tiff, cut_anywhere_is_refused_when_it_is_opened) {
  const TemporaryFolder folder;
  const auto file = folder / "a.tif";
  const std::vector<Picture> pages{make_picture(64, 48, 2, 1), make_picture(64, 48, 2, 2)};
  for (const double fraction : {0.001, 0.3, 0.5, 0.7, 0.9, 0.999}) {
    write_tiff(file, pages);
    cut_short(file, fraction);
    const auto [code, text] = error_of([&] { open_image(file); });
    EXPECT_EQ(code, ExitCode::bad_data) << fraction;
    EXPECT_THAT(text, HasSubstr(file.string()));
  }
}

TEST(Tiff, cut_after_it_was_opened_is_an_error_of_the_decoder) {
  const TemporaryFolder folder;
  const auto file = folder / "a.tif";
  const std::vector<Picture> pages{make_picture(256, 256, 2, 1), make_picture(256, 256, 2, 2)};
  write_tiff(file, pages);
  const auto reader = open_image(file);
  cut_short(file, 0.25);
  std::vector<std::byte> pixels(pages[0].shape.bytes());
  EXPECT_EQ(error_of([&] { reader->decode(0, pixels); }).first, ExitCode::bad_data);
  EXPECT_EQ(error_of([&] { reader->decode(1, pixels); }).first, ExitCode::bad_data);
}

TEST(ImageFile, names_what_is_wrong_with_files_that_are_no_images) {
  const TemporaryFolder folder;
  EXPECT_EQ(error_of([&] { open_image(folder / "none.png"); }).first, ExitCode::no_input);
  write_text(folder / "empty.png", "");
  EXPECT_THAT(error_of([&] { open_image(folder / "empty.png"); }).second, HasSubstr("the file is empty"));
  write_text(folder / "text.tif", "not an image at all");
  EXPECT_THAT(error_of([&] { open_image(folder / "text.tif"); }).second, HasSubstr("neither PNG nor TIFF"));
  EXPECT_EQ(error_of([&] { open_image(folder.path()); }).first, ExitCode::io);
}

}  // namespace
}  // namespace rptv::testing
