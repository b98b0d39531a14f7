// SPDX-License-Identifier: MIT
// The light-field data sets of the research data folder: images, truth and the scenario that they were made from.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "simulation/scenario.hpp"
#include "simulation/tracers.hpp"

namespace rptv {

/// Grey values of one 16-bit image, row by row.
struct SharedImage {
  std::vector<double> grey;
  std::size_t width = 0, height = 0;
  double mean() const;
};

/// A particle of a data set made with a real lens, in this project's frames (z towards the lens).
struct SharedParticle {
  int layer = 0;
  Vector3 object, image_paraxial, image_real;
  double photoelectrons = 0;
};

/// One of the sets lf-macro and lf-edge: the double Gauss of an independent ray tracer.
class SharedLightField {
 public:
  /// None when RPTV_SHARED_DATA does not name a folder that has the set.
  static std::optional<SharedLightField> open(const std::string& set);

  SharedImage image(const std::string& name) const;
  const std::vector<SharedParticle>& particles() const noexcept { return particles_; }
  /// The set's camera, without noise and with gain 1; the lens by the path of its prescription.
  ScenarioSettings scenario() const;
  /// The particles of one layer, as the renderer takes them.
  std::vector<Tracer> tracers(int layer) const;
  /// Number behind a key of the truth, the first of that name.
  double number(std::string_view key) const;

 private:
  /// All numbers of the list behind a key's n-th occurrence.
  std::vector<double> list(std::string_view key, std::size_t occurrence = 0) const;
  std::filesystem::path folder_;
  std::string truth_;
  std::vector<SharedParticle> particles_;
};

}  // namespace rptv
