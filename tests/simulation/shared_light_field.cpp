// SPDX-License-Identifier: MIT
// Reading of the light-field data sets: as much JSON as their truth needs.
#include "tests/simulation/shared_light_field.hpp"

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <numeric>

#include "replay/image_file.hpp"

namespace rptv {

double SharedImage::mean() const {
  return std::accumulate(grey.begin(), grey.end(), 0.0) / static_cast<double>(grey.size());
}

std::optional<SharedLightField> SharedLightField::open(const std::string& set) {
  const char* data = std::getenv("RPTV_SHARED_DATA");
  SharedLightField out;
  if (data == nullptr) return std::nullopt;
  out.folder_ = std::filesystem::path(data) / set;
  std::ifstream stream(out.folder_ / "truth.json");
  if (!stream) return std::nullopt;
  out.truth_.assign(std::istreambuf_iterator<char>(stream), {});
  const double focus = 2 * out.number("EFL_mm");
  std::size_t i = 0;
  for (auto object = out.list("object_mm", i); object.size() == 3; object = out.list("object_mm", ++i)) {
    const auto paraxial = out.list("image_paraxial_mm", i), real = out.list("image_real_ls_mm", i);
    const auto photons = out.list("photons_through_lens", i);
    const double z = focus - object[2];
    out.particles_.push_back({z > 1    ? 0
                              : z > -1 ? 1
                                       : 2,
                              {object[0], object[1], z},
                              {paraxial[0], paraxial[1], -paraxial[2]},
                              {real[0], real[1], -real[2]},
                              photons[0]});
  }
  return out;
}

std::vector<double> SharedLightField::list(std::string_view key, std::size_t occurrence) const {
  const std::string quoted = "\"" + std::string(key) + "\":";
  std::size_t at = truth_.find(quoted);
  for (; occurrence > 0 && at != std::string::npos; --occurrence) at = truth_.find(quoted, at + 1);
  std::vector<double> numbers;
  if (at == std::string::npos) return numbers;
  const char* place = truth_.c_str() + at + quoted.size();
  place += std::string_view(place).find_first_not_of(" \n");
  const bool many = *place == '[';
  int depth = 0;
  while (*place != '\0') {
    if (*place == '[') ++depth;
    if (*place == ']' && --depth == 0) break;
    char* end = nullptr;
    const double value = std::strtod(place, &end);
    if (end != place) numbers.push_back(value);
    if (!many) break;
    place = end != place ? end : place + 1;
  }
  return numbers;
}

double SharedLightField::number(std::string_view key) const { return list(key).at(0); }

SharedImage SharedLightField::image(const std::string& name) const {
  const auto reader = open_image(folder_ / name);
  const ImageShape shape = reader->header(0).shape;
  std::vector<std::uint16_t> pixels(shape.pixels());
  reader->decode(0, std::as_writable_bytes(std::span(pixels)));
  return {{pixels.begin(), pixels.end()}, shape.width_px, shape.height_px};
}

ScenarioSettings SharedLightField::scenario() const {
  ScenarioSettings s;
  s.rays_per_particle = 100000;
  s.flow.kind = "layers";
  s.seeding.particle_radius_um = 1e3 * number("particle_radius_mm");
  s.seeding.photoelectrons = 700000 / (1.35 * 1.35);  // rays launched towards 1.35 entrance pupils
  s.seeding.equal_light = true;
  s.seeding.volume_x_mm = 18;
  s.seeding.volume_y_mm = 14;
  s.main_lens.model = "prescription";
  s.main_lens.prescription = std::string(RPTV_SOURCE_DIR) + "/simulation/prescriptions/double_gauss_f2.toml";
  s.main_lens.magnification = 1;
  s.main_lens.stop_radius_mm = number("stop_radius_mm");
  const auto rims = list("extra_rims_z_radius");
  for (std::size_t i = 0; i + 1 < rims.size(); i += 2) {
    s.main_lens.rim_z_mm.push_back(rims[i]);
    s.main_lens.rim_radius_mm.push_back(rims[i + 1]);
  }
  s.lenslets.model = "plano_convex";
  s.lenslets.diffraction = false;
  s.lenslets.rotation_deg = number("rotation_deg");
  s.lenslets.offset_x_mm = list("offset_mm").at(0);
  s.lenslets.offset_y_mm = list("offset_mm").at(1);
  s.camera.width_px = static_cast<std::int64_t>(number("width_px"));
  s.camera.height_px = static_cast<std::int64_t>(number("height_px"));
  s.camera.pixel_um = 1e3 * number("pixel_mm");
  s.camera.bits = 16;
  s.camera.gain_e_per_dn = 1;
  s.camera.black_level_dn = 0;
  s.camera.noise = false;
  return s;
}

std::vector<Tracer> SharedLightField::tracers(int layer) const {
  std::vector<Tracer> tracers;
  for (const auto& particle : particles_)
    if (particle.layer == layer) tracers.push_back({tracers.size(), 0, particle.object, {}});
  return tracers;
}

}  // namespace rptv
