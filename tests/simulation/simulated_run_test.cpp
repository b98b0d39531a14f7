// SPDX-License-Identifier: MIT
// A simulated run as a folder: complete, the same for every number of threads, and accepted by what reads it.
#include "daemon/simulated_run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <iterator>

#include "calibration/light_field/light_field_calibration.hpp"
#include "core/csv.hpp"
#include "core/error.hpp"
#include "daemon/config.hpp"
#include "daemon/progress.hpp"
#include "replay/image_file.hpp"
#include "simulation/optics.hpp"
#include "simulation/truth.hpp"

namespace rptv {
namespace {

namespace fs = std::filesystem;

ScenarioSettings small_scene() {
  ScenarioSettings scenario;
  scenario.frames = 4;
  scenario.camera.width_px = 192;
  scenario.camera.height_px = 160;
  scenario.seeding.particles = 5;
  return scenario;
}

class SimulatedRun : public testing::Test {
 protected:
  SimulatedRun() { fs::create_directories(folder_); }
  ~SimulatedRun() override { fs::remove_all(folder_); }
  const fs::path folder_ = fs::path(testing::TempDir()) / ("simulated_run_" + std::to_string(getpid()));
};

std::string bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST_F(SimulatedRun, holds_frames_times_truth_and_calibration) {
  const auto scenario = small_scene();
  const auto report = write_simulated_run(scenario, {folder_, 2});
  EXPECT_EQ(report.frames, 4U);
  const SimulatedRunFiles files(folder_);
  for (std::uint64_t frame = 0; frame < 4; ++frame) {
    const auto image = open_image(files.frame(frame));
    EXPECT_EQ(image->header(0).shape, (ImageShape{192, 160, 2}));
    EXPECT_EQ(image->header(0).significant_bits, 12U);
  }
  CsvReader times(files.frame_times, {{"frame"}, {"t"}});
  for (std::uint64_t frame = 0; frame < 4; ++frame) {
    ASSERT_TRUE(times.next());
    EXPECT_EQ(times.index(0), frame);
    EXPECT_DOUBLE_EQ(times.number(1), static_cast<double>(frame) / scenario.rate_hz);
  }
  const auto truth = read_truth(files.truth);
  EXPECT_EQ(truth.back().frame, 3U);
  EXPECT_NEAR(static_cast<double>(truth.size()) / 4, report.particles_per_frame, 1e-9);
  EXPECT_EQ(read_light_field_calibration(files.calibration).sensor.width_px, 192);
  EXPECT_EQ(read_scenario(files.scenario).frames, 4);
  for (const auto& image : {files.white, files.white_stopped, files.dark, files.background})
    EXPECT_EQ(open_image(image)->header(0).shape.width_px, 192U);
}

TEST_F(SimulatedRun, tells_where_images_lie_and_how_bright_they_are) {
  const auto scenario = small_scene();
  write_simulated_run(scenario, {folder_, 1});
  const LightFieldOptics optics(scenario);
  CsvReader truth(SimulatedRunFiles(folder_).truth,
                  {{"x"}, {"y"}, {"z"}, {"image_x"}, {"image_z"}, {"real_x"}, {"real_z"}, {"photoelectrons"}});
  std::size_t rows = 0;
  for (; truth.next(); ++rows) {
    const auto image = optics.image_of({truth.number(0), truth.number(1), truth.number(2)});
    EXPECT_DOUBLE_EQ(truth.number(3), image.x);
    EXPECT_DOUBLE_EQ(truth.number(4), image.z);
    EXPECT_DOUBLE_EQ(truth.number(5), image.x);  // a thick lens is ideal
    EXPECT_DOUBLE_EQ(truth.number(6), image.z);
    EXPECT_NEAR(truth.number(7), scenario.seeding.photoelectrons * optics.brightness(truth.number(2)), 1e-6 * 40000);
  }
  EXPECT_GT(rows, 10U);
  CsvReader volume(SimulatedRunFiles(folder_).volume_truth,
                   {{"image_x"}, {"image_y"}, {"image_z"}, {"object_x"}, {"object_y"}, {"object_z"}});
  rows = 0;
  for (; volume.next(); ++rows)
    EXPECT_DOUBLE_EQ(volume.number(1), optics.image_of({volume.number(3), volume.number(4), volume.number(5)}).y);
  EXPECT_EQ(rows, 11U * 11 * 11);
}

TEST_F(SimulatedRun, of_a_traced_lens_is_complete_and_threads_do_not_matter) {
  ScenarioSettings scenario = small_scene();
  scenario.main_lens.model = "prescription";
  scenario.main_lens.prescription = std::string(RPTV_SOURCE_DIR) + "/simulation/prescriptions/macro_25mm_f28.toml";
  scenario.main_lens.magnification = 2.5;
  scenario.main_lens.stop_radius_mm = 1.4;
  scenario.lenslets.model = "plano_convex";
  scenario.seeding.volume_x_mm = scenario.seeding.volume_y_mm = 1;
  scenario.flow.wall_y_mm = -0.5;
  write_simulated_run(scenario, {folder_ / "one", 1});
  write_simulated_run(scenario, {folder_ / "two", 2});
  const SimulatedRunFiles one(folder_ / "one"), two(folder_ / "two");
  EXPECT_EQ(bytes_of(one.truth), bytes_of(two.truth));
  for (std::uint64_t frame = 0; frame < 4; ++frame) EXPECT_EQ(bytes_of(one.frame(frame)), bytes_of(two.frame(frame)));
  EXPECT_NEAR(read_light_field_calibration(one.calibration).magnification(), 2.5, 1e-9);
  EXPECT_NO_THROW(load_config(one.rig));
  EXPECT_EQ(read_scenario(one.scenario).main_lens.prescription, scenario.main_lens.prescription);
}

TEST_F(SimulatedRun, is_the_same_with_one_thread_and_with_three) {
  write_simulated_run(small_scene(), {folder_ / "one", 1});
  write_simulated_run(small_scene(), {folder_ / "three", 3});
  std::size_t compared = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "one")) {
    if (!entry.is_regular_file()) continue;
    EXPECT_EQ(bytes_of(entry.path()), bytes_of(folder_ / "three" / fs::relative(entry.path(), folder_ / "one")))
        << entry.path();
    ++compared;
  }
  EXPECT_EQ(compared, 4U + 10U);
}

TEST_F(SimulatedRun, leaves_no_frames_of_a_longer_run_behind) {
  auto scenario = small_scene();
  write_simulated_run(scenario, {folder_, 1});
  scenario.frames = 2;
  write_simulated_run(scenario, {folder_, 1});
  EXPECT_TRUE(fs::exists(SimulatedRunFiles(folder_).frame(1)));
  EXPECT_FALSE(fs::exists(SimulatedRunFiles(folder_).frame(2)));
}

TEST_F(SimulatedRun, comes_with_a_configuration_that_the_daemon_reads) {
  ScenarioSettings scenario;
  write_simulated_run(small_scene(), {folder_, 1});
  const Config config = load_config(SimulatedRunFiles(folder_).rig);
  EXPECT_EQ(fs::path(config.replay.path), fs::absolute(SimulatedRunFiles(folder_).frames));
  EXPECT_TRUE(fs::exists(config.light_field.calibration));
  EXPECT_TRUE(fs::exists(config.light_field.background_image));
  ASSERT_EQ(config.light_field.volume_z_mm.size(), 2U);
  EXPECT_LT(config.light_field.volume_z_mm[0], 87.5 - 787.5 / 6.5);   // image of the near face, s = 31.5
  EXPECT_GT(config.light_field.volume_z_mm[1], 87.5 - 962.5 / 13.5);  // image of the far face, s = 38.5
  const double step = 2 * M_PI * scenario.flow.frequency_hz * scenario.flow.wall_amplitude_mm / scenario.rate_hz;
  EXPECT_GT(config.linker.search_range_mm, step);
}

TEST_F(SimulatedRun, refuses_a_folder_that_cannot_be) {
  std::ofstream(folder_ / "taken") << "a file";
  try {
    write_simulated_run(small_scene(), {folder_ / "taken", 1});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::io);
    EXPECT_THAT(error.what(), testing::HasSubstr("taken"));
  }
}

TEST(Progress, says_share_rate_and_time_left) {
  const auto line = progress_line("simulate", 75, 300, 1.5, 120);
  EXPECT_THAT(line, testing::HasSubstr("simulate [######...."));
  EXPECT_THAT(line, testing::HasSubstr("25 % 75/300"));
  EXPECT_THAT(line, testing::HasSubstr("50/s"));
  EXPECT_THAT(line, testing::HasSubstr("0:05 left"));
}

TEST(Progress, fits_a_narrow_terminal_and_survives_odd_counts) {
  EXPECT_EQ(progress_line("simulate", 75, 300, 1.5, 20).size(), 20U);
  EXPECT_THAT(progress_line("simulate", 0, 300, 0, 120), testing::HasSubstr("-:-- left"));
  EXPECT_THAT(progress_line("simulate", 5, 0, 1, 120), testing::HasSubstr("100 %"));
}

}  // namespace
}  // namespace rptv
