// SPDX-License-Identifier: MIT
// Making of the rig, and the list of mistakes.
#include "tests/daemon/bad_rig.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "replay/image_file.hpp"

namespace rptv::testing {
namespace {

namespace fs = std::filesystem;
constexpr ImageShape kShape{128, 96, 2};

void require(bool condition) {
  if (!condition) std::abort();
}

void write(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::binary) << text; }

std::string read(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

}  // namespace

Rig::Rig() {
  std::string name = "/tmp/rapidptv-rig-XXXXXX";
  require(mkdtemp(name.data()) != nullptr);
  folder = name;
  fs::permissions(folder, fs::perms(0777));
  fs::create_directory(folder / "frames");
  for (int i = 0; i < 5; ++i) write_frame(i, kShape);
  write(calibration(),
        "schema = 1\n[sensor]\nwidth_px = 128\nheight_px = 96\npixel_um = 5.0\n"
        "[lenslets]\npitch_um = 80.0\nfocal_length_mm = 1.0\n"
        "[lens]\nmodel = \"telecentric\"\nexit_pupil_mm = 0\nimage_f_number = 16\nmagnification = 2.0\n");
  write(config(), fmt::format("schema = 1\n[replay]\npath = \"frames\"\nrate_hz = 100\nspeed = 0\n"
                              "[intake]\npolicy = \"lossless\"\n"
                              "[light_field]\ncalibration = \"calibration.toml\"\nvolume_z_mm = [-1, "
                              "1]\nparticle_radius_um = 50\nthreads = 1\n"
                              "[publisher]\nendpoint = \"ipc://{}/tracks.sock\"\n",
                              folder.string()));
}

Rig::~Rig() {
  if (listener_ >= 0) close(listener_);
  fs::remove_all(folder);
}

fs::path Rig::frame(int index) const { return folder / "frames" / fmt::format("frame_{:05}.png", index); }

void Rig::write_frame(int index, ImageShape shape) const {
  std::vector<std::byte> pixels(shape.bytes());
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = std::byte(i * 2654435761U >> 24);
  write_png(frame(index), {pixels.data(), shape});
}

void Rig::replace(const fs::path& file, const std::string& what, const std::string& with) const {
  std::string text = read(file);
  const std::size_t at = text.find(what);
  require(at != std::string::npos);
  write(file, text.replace(at, what.size(), with));
}

std::string Rig::taken_port() {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof address;
  auto* generic = reinterpret_cast<sockaddr*>(&address);
  listener_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  require(listener_ >= 0 && bind(listener_, generic, length) == 0 && listen(listener_, 1) == 0 &&
          getsockname(listener_, generic, &length) == 0);
  return std::to_string(ntohs(address.sin_port));
}

std::vector<BadInput> bad_inputs() {
  const auto endpoint = [](Rig& rig, const std::string& text) {
    rig.replace(rig.config(), "ipc://" + rig.folder.string() + "/tracks.sock", text);
  };
  using Code = ExitCode;
  return {
      {"missing_config", [](Rig& r) { fs::remove(r.config()); }, Code::no_input, {"rig.toml", "configuration file"}},
      {"missing_folder", [](Rig& r) { fs::remove_all(r.folder / "frames"); }, Code::no_input, {"/frames"}},
      {"truncated_png",
       [](Rig& r) { fs::resize_file(r.frame(2), fs::file_size(r.frame(2)) / 2); },
       Code::bad_data,
       {"frame_00002.png"}},
      {"mixed_sizes",
       [](Rig& r) {
         r.write_frame(3, {128, 64, 2});
       },
       Code::bad_data,
       {"frame_00003.png", "64", "96"}},
      {"eight_bit_in_a_16_bit_series",
       [](Rig& r) {
         r.write_frame(3, {128, 96, 1});
       },
       Code::bad_data,
       {"frame_00003.png", "8", "16"}},
      {"empty_file", [](Rig& r) { write(r.frame(1), ""); }, Code::bad_data, {"frame_00001.png", "empty"}},
      {"not_an_image", [](Rig& r) { write(r.frame(1), "GIF89a and so on"); }, Code::bad_data, {"frame_00001.png"}},
      {"nan_pitch",
       [](Rig& r) { r.replace(r.calibration(), "80.0", "nan"); },
       Code::configuration,
       {"calibration.toml:7:12: 'lenslets.pitch_um' is nan"}},
      {"zero_pitch",
       [](Rig& r) { r.replace(r.calibration(), "80.0", "0.0"); },
       Code::configuration,
       {"calibration.toml:7:12: 'lenslets.pitch_um' is 0.0"}},
      {"missing_calibration", [](Rig& r) { fs::remove(r.calibration()); }, Code::no_input, {"calibration.toml"}},
      {"calibration_of_another_camera",
       [](Rig& r) { r.replace(r.calibration(), "128", "256"); },
       Code::configuration,
       {"calibration.toml", "256 x 96", "128 x 96"}},
      {"unknown_key",
       [](Rig& r) { r.replace(r.config(), "rate_hz", "rate_khz"); },
       Code::configuration,
       {"rig.toml:4:1: unknown key 'replay.rate_khz'", "did you mean 'rate_hz'"}},
      {"wrong_type",
       [](Rig& r) { r.replace(r.config(), "100", "'fast'"); },
       Code::configuration,
       {"rig.toml:4:11: 'replay.rate_hz' is 'fast'", "must be"}},
      {"syntax_error",
       [](Rig& r) { r.replace(r.config(), "\"frames\"", "\"frames"); },
       Code::configuration,
       {"rig.toml:3:", "no valid TOML"}},
      {"newer_schema",
       [](Rig& r) { r.replace(r.config(), "schema = 1", "schema = 7"); },
       Code::configuration,
       {"rig.toml:1:10: schema 7", "update rapidptv"}},
      {"port_in_use",
       [endpoint](Rig& r) { endpoint(r, "tcp://127.0.0.1:" + r.taken_port()); },
       Code::unavailable,
       {"tcp://127.0.0.1:"}},
      {"endpoint_without_permission",
       [endpoint](Rig& r) {
         fs::create_directory(r.folder / "locked");
         fs::permissions(r.folder / "locked", fs::perms(0555));
         endpoint(r, "ipc://" + (r.folder / "locked/tracks.sock").string());
       },
       Code::permission,
       {"locked"},
       true},
      {"endpoint_without_folder",
       [endpoint](Rig& r) { endpoint(r, "ipc:///nowhere/at/all.sock"); },
       Code::configuration,
       {"/nowhere/at/all.sock"}},
      {"endpoint_open_to_the_world",
       [endpoint](Rig& r) { endpoint(r, "tcp://0.0.0.0:5599"); },
       Code::configuration,
       {"tcp://0.0.0.0:5599", "curve_secret_key_file"}},
      {"endpoint_that_is_none",
       [endpoint](Rig& r) { endpoint(r, "udp:somewhere"); },
       Code::configuration,
       {"udp:somewhere"}},
      {"output_without_folder",
       [](Rig& r) { r.replace(r.config(), "[intake]", "[output]\ntracks = 'no/t.csv'\n[intake]"); },
       Code::io,
       {"no/t.csv", "folder"}},
  };
}

}  // namespace rptv::testing
