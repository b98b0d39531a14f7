// SPDX-License-Identifier: MIT
// Which images of a folder are found, in which order, for which camera; and what is refused before the start.
#include "replay/image_sequence.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/replay/image_maker.hpp"

namespace rptv::testing {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

void add_png(const TemporaryFolder& folder, const std::string& name, std::uint32_t seed = 1) {
  std::filesystem::create_directories((folder / name).parent_path());
  write_png(folder / name, make_picture(12, 10, 2, seed).view());
}

std::vector<std::string> names(const ImageSequence& images) {
  std::vector<std::string> found;
  for (std::size_t i = 0; i < images.size(); ++i) found.push_back(images.file(i).filename().string());
  return found;
}

std::vector<std::uint64_t> numbers(const ImageSequence& images) {
  std::vector<std::uint64_t> found;
  for (std::size_t i = 0; i < images.size(); ++i) found.push_back(images.number(i));
  return found;
}

TEST(OpenCameras, sorts_by_the_number_in_the_name) {
  const TemporaryFolder folder;
  for (const char* name : {"frame_10.png", "frame_9.png", "frame_100.png", "frame_1.png"}) add_png(folder, name);
  const auto cameras = open_cameras(folder.path());
  ASSERT_EQ(cameras.size(), 1U);
  EXPECT_EQ(cameras[0].camera(), "cam0");
  EXPECT_THAT(names(cameras[0]), ElementsAre("frame_1.png", "frame_9.png", "frame_10.png", "frame_100.png"));
  EXPECT_THAT(numbers(cameras[0]), ElementsAre(1, 9, 10, 100));
}

TEST(OpenCameras, takes_only_frames_when_there_are_frames) {
  const TemporaryFolder folder;
  for (const char* name : {"frame_0.png", "frame_1.png", "dark.png", "other_2.png", "cam0_1.png"})
    add_png(folder, name);
  write_text(folder / "truth.json", "{}");
  EXPECT_THAT(names(open_cameras(folder.path())[0]), ElementsAre("frame_0.png", "frame_1.png"));
}

TEST(OpenCameras, leaves_dark_white_and_background_out) {
  const TemporaryFolder folder;
  for (const char* name : {"shot1.png", "shot2.PNG", "dark.png", "white_stopped.png", "background.png", "._shot3.png"})
    add_png(folder, name);
  EXPECT_THAT(names(open_cameras(folder.path())[0]), ElementsAre("shot1.png", "shot2.PNG"));
}

TEST(OpenCameras, takes_what_the_pattern_says) {
  const TemporaryFolder folder;
  for (const char* name : {"frame_0.png", "dark_0.png", "dark_1.png"}) add_png(folder, name);
  EXPECT_THAT(names(open_cameras(folder.path(), "dark_*")[0]), ElementsAre("dark_0.png", "dark_1.png"));
  const auto [code, text] = error_of([&] { open_cameras(folder.path(), "light_*"); });
  EXPECT_EQ(code, ExitCode::no_input);
  EXPECT_THAT(text, AllOf(HasSubstr(folder.path().string()), HasSubstr("'light_*'"), HasSubstr("dark_0.png")));
}

TEST(OpenCameras, finds_one_camera_per_sub_folder) {
  const TemporaryFolder folder;
  for (const char* name : {"cam10/a_0.tif", "cam2/a_0.png", "cam2/a_1.png", "notes/x.png"}) add_png(folder, name);
  const auto cameras = open_cameras(folder.path());
  ASSERT_EQ(cameras.size(), 2U);
  EXPECT_EQ(cameras[0].camera(), "cam2");
  EXPECT_EQ(cameras[1].camera(), "cam10");
  EXPECT_EQ(cameras[0].size(), 2U);
}

TEST(OpenCameras, finds_one_camera_per_prefix) {
  const TemporaryFolder folder;
  for (const char* name : {"cam1_10000.png", "cam1_10001.png", "cam2_10000.png", "cam2_10002.png", "dark.png"})
    add_png(folder, name);
  const auto cameras = open_cameras(folder.path());
  ASSERT_EQ(cameras.size(), 2U);
  EXPECT_EQ(cameras[1].camera(), "cam2");
  EXPECT_THAT(numbers(cameras[1]), ElementsAre(10000, 10002));
}

TEST(OpenCameras, finds_one_camera_per_multi_page_file) {
  const TemporaryFolder folder;
  const std::vector<Picture> pages{make_picture(12, 10, 1, 1), make_picture(12, 10, 1, 2)};
  write_tiff(folder / "cam0.tif", pages);
  write_tiff(folder / "cam1.tif", pages);
  const auto cameras = open_cameras(folder.path());
  ASSERT_EQ(cameras.size(), 2U);
  EXPECT_THAT(numbers(cameras[1]), ElementsAre(0, 1));
}

TEST(OpenCameras, reads_the_pages_of_one_file_in_any_order) {
  const TemporaryFolder folder;
  std::vector<Picture> pages;
  for (std::uint32_t i = 0; i < 5; ++i) pages.push_back(make_picture(20, 15, 2, i));
  write_tiff(folder / "run.tiff", pages, {.big_tiff = true});
  const auto cameras = open_cameras(folder / "run.tiff");
  ASSERT_EQ(cameras[0].size(), 5U);
  ImageSequence::Reader reader(cameras[0]);
  for (const std::size_t i : {4U, 0U, 3U, 3U}) {
    std::vector<std::byte> pixels(cameras[0].shape().bytes());
    reader.decode(i, pixels);
    EXPECT_EQ(pixels, pages[i].pixels);
  }
}

TEST(OpenCameras, numbers_by_position_when_the_names_differ_in_more_than_a_number) {
  const TemporaryFolder folder;
  for (const char* name : {"a_7.png", "b_5.png", "c.png"}) add_png(folder, name);
  EXPECT_THAT(numbers(open_cameras(folder.path())[0]), ElementsAre(0, 1, 2));
}

class BadFolder : public ::testing::Test {
 protected:
  /// Code and text; the text names `file`, is one line, and does not name a good file first.
  std::string refusal(ExitCode expected, const std::string& file) {
    const auto [code, text] = error_of([this] { open_cameras(folder.path()); });
    EXPECT_EQ(code, expected) << text;
    const auto named = file.empty() ? folder.path() : folder / file;
    EXPECT_EQ(text.rfind(named.string() + ": ", 0), 0U) << text;
    EXPECT_THAT(text, AllOf(Not(HasSubstr("\n")), HasSubstr("; ")));
    return text;
  }
  TemporaryFolder folder;
};

TEST_F(BadFolder, with_mixed_sizes_names_the_first_that_differs) {
  add_png(folder, "frame_0.png");
  add_png(folder, "frame_1.png");
  write_png(folder / "frame_2.png", make_picture(13, 10, 2, 1).view());
  EXPECT_THAT(refusal(ExitCode::bad_data, "frame_2.png"), AllOf(HasSubstr("13 x 10"), HasSubstr("12 x 10")));
}

TEST_F(BadFolder, with_8_bits_among_16_names_the_file) {
  add_png(folder, "frame_0.png");
  write_png(folder / "frame_1.png", make_picture(12, 10, 1, 1).view());
  EXPECT_THAT(refusal(ExitCode::bad_data, "frame_1.png"),
              AllOf(HasSubstr("has 8 bits"), HasSubstr("frame_0.png has 16")));
}

TEST_F(BadFolder, with_an_empty_file_names_it) {
  add_png(folder, "frame_0.png");
  write_text(folder / "frame_1.png", "");
  EXPECT_THAT(refusal(ExitCode::bad_data, "frame_1.png"), HasSubstr("empty"));
}

TEST_F(BadFolder, with_a_truncated_png_names_it) {
  add_png(folder, "frame_0.png");
  add_png(folder, "frame_1.png");
  cut_short(folder / "frame_1.png", 0.8);
  EXPECT_THAT(refusal(ExitCode::bad_data, "frame_1.png"), HasSubstr("truncated"));
}

TEST_F(BadFolder, with_a_multi_page_file_among_images_names_it) {
  add_png(folder, "frame_0.png");
  write_tiff(folder / "frame_1.tif", {make_picture(12, 10, 2, 1), make_picture(12, 10, 2, 2)});
  EXPECT_THAT(refusal(ExitCode::bad_data, "frame_1.tif"), HasSubstr("holds 2 images"));
}

TEST_F(BadFolder, without_images_says_so) {
  EXPECT_THAT(refusal(ExitCode::no_input, ""), HasSubstr("no PNG or TIFF"));
  add_png(folder, "dark.png");
  EXPECT_THAT(refusal(ExitCode::no_input, ""), HasSubstr("only dark"));
}

TEST_F(BadFolder, with_17_cameras_says_how_many_are_supported) {
  for (int camera = 0; camera < 17; ++camera) add_png(folder, "cam" + std::to_string(camera) + "_0.png");
  EXPECT_THAT(refusal(ExitCode::configuration, ""), AllOf(HasSubstr("17 cameras"), HasSubstr("at most 16")));
}

TEST(OpenCameras, says_that_a_folder_is_missing) {
  const TemporaryFolder folder;
  const auto [code, text] = error_of([&] { open_cameras(folder / "nowhere"); });
  EXPECT_EQ(code, ExitCode::no_input);
  EXPECT_THAT(text, AllOf(HasSubstr("nowhere"), HasSubstr("No such file"), HasSubstr("check the path")));
  EXPECT_EQ(error_of([] { open_cameras(""); }).first, ExitCode::configuration);
}

TEST(ImageSequence, notices_that_a_file_was_replaced) {
  const TemporaryFolder folder;
  add_png(folder, "frame_0.png");
  const auto cameras = open_cameras(folder.path());
  write_png(folder / "frame_0.png", make_picture(90, 90, 2, 1).view());
  ImageSequence::Reader reader(cameras[0]);
  std::vector<std::byte> pixels(cameras[0].shape().bytes());
  EXPECT_THAT(error_of([&] { reader.decode(0, pixels); }).second, HasSubstr("changed"));
}

}  // namespace
}  // namespace rptv::testing
