// SPDX-License-Identifier: MIT
// `rapidptv cameras` as a process, beside a GigE Vision camera that answers on loopback.
#include <arv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <memory>

namespace rptv {
namespace {

std::string output_of(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), &pclose);
  std::string text;
  std::array<char, 4096> some{};
  while (const std::size_t count = fread(some.data(), 1, some.size(), pipe.get())) text.append(some.data(), count);
  return text;
}

TEST(Cameras, lists_what_answers_by_the_address_that_a_configuration_names_it_by) {
  const auto drop = [](ArvGvFakeCamera* camera) { g_object_unref(camera); };
  const std::unique_ptr<ArvGvFakeCamera, decltype(drop)> camera(arv_gv_fake_camera_new("127.0.0.1", "RP42"), drop);
  ASSERT_TRUE(arv_gv_fake_camera_is_running(camera.get()));
  const std::string text = output_of(std::string(std::getenv("RAPIDPTV")) + " cameras --json");
  EXPECT_THAT(
      text,
      ::testing::HasSubstr(
          R"({"bus": "GigEVision", "address": "127.0.0.1", "vendor": "Aravis", "model": "Fake", "serial": "RP42", )"
          R"("formats": [)"));
  EXPECT_THAT(text, ::testing::HasSubstr("\"Mono16\""));
  EXPECT_THAT(output_of(std::string(std::getenv("RAPIDPTV")) + " cameras"), ::testing::HasSubstr("127.0.0.1"));
}

}  // namespace
}  // namespace rptv
