// SPDX-License-Identifier: MIT
// `rapidptv cameras` as a process, beside a GigE Vision camera that answers on loopback.
#include <arv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "tests/daemon/run_binary.hpp"

namespace rptv {
namespace {

TEST(Cameras, lists_what_answers_by_the_address_that_a_configuration_names_it_by) {
  const auto drop = [](ArvGvFakeCamera* camera) { g_object_unref(camera); };
  const std::unique_ptr<ArvGvFakeCamera, decltype(drop)> camera(arv_gv_fake_camera_new("127.0.0.1", "RP42"), drop);
  ASSERT_TRUE(arv_gv_fake_camera_is_running(camera.get()));
  const std::string text = testing::run_rapidptv({"cameras", "--json"}).out;
  EXPECT_THAT(
      text,
      ::testing::HasSubstr(
          R"({"bus": "GigEVision", "address": "127.0.0.1", "vendor": "Aravis", "model": "Fake", "serial": "RP42", )"
          R"("formats": [)"));
  EXPECT_THAT(text, ::testing::HasSubstr("\"Mono16\""));
  EXPECT_THAT(testing::run_rapidptv({"cameras"}).out, ::testing::HasSubstr("127.0.0.1"));
}

}  // namespace
}  // namespace rptv
