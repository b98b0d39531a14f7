// SPDX-License-Identifier: MIT
// Reads images and truth of the shared light-field sets, and matches found particles with true ones.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "core/particles.hpp"
#include "replay/image_file.hpp"

namespace rptv::testing {

using Position = std::array<double, 3>;

/// Folder of a shared set, when there is one.
inline std::optional<std::filesystem::path> shared_set(const std::string& name) {
  const char* root = std::getenv("RPTV_SHARED_DATA");
  if (root == nullptr || !std::filesystem::exists(std::filesystem::path(root) / name / "truth.json")) return {};
  return std::filesystem::path(root) / name;
}

inline std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

struct DecodedImage {
  explicit DecodedImage(const std::filesystem::path& file) {
    const auto reader = open_image(file);
    shape = reader->header(0).shape;
    bytes.resize(shape.bytes());
    reader->decode(0, bytes);
  }
  ImageView view() const { return {bytes.data(), shape}; }
  ImageShape shape;
  std::vector<std::byte> bytes;
};

/// A true particle may be found by the nearest found one within `lateral_mm` and `depth_mm`; pairs are one-to-one,
/// taken in order of their distance, in which depth is scaled so that both limits weigh the same.
struct Match {
  std::size_t found, truth;
};

inline std::vector<Match> match(const Particles& found, const std::vector<Position>& truth, double lateral_mm,
                                double depth_mm) {
  struct Pair {
    double distance;
    Match match;
  };
  std::vector<Pair> pairs;
  for (std::size_t f = 0; f < found.size(); ++f)
    for (std::size_t t = 0; t < truth.size(); ++t) {
      const double lateral = std::hypot(found.x_mm[f] - truth[t][0], found.y_mm[f] - truth[t][1]);
      const double depth = std::abs(found.z_mm[f] - truth[t][2]);
      if (lateral <= lateral_mm && depth <= depth_mm)
        pairs.push_back({std::hypot(lateral / lateral_mm, depth / depth_mm), {f, t}});
    }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.distance < b.distance; });
  std::vector<char> found_used(found.size()), truth_used(truth.size());
  std::vector<Match> matches;
  for (const auto& [distance, m] : pairs) {
    if (found_used[m.found] != 0 || truth_used[m.truth] != 0) continue;
    found_used[m.found] = truth_used[m.truth] = 1;
    matches.push_back(m);
  }
  return matches;
}

/// What a set of matches says about position errors, mm.
struct ErrorFigures {
  double mean = 0;  ///< of the distance
  Position rms{}, bias{};
};

inline ErrorFigures errors_of(const Particles& found, const std::vector<Position>& truth,
                              const std::vector<Match>& matches) {
  ErrorFigures figures;
  for (const auto& m : matches) {
    const Position e{found.x_mm[m.found] - truth[m.truth][0], found.y_mm[m.found] - truth[m.truth][1],
                     found.z_mm[m.found] - truth[m.truth][2]};
    figures.mean += std::hypot(e[0], e[1], e[2]);
    for (std::size_t k = 0; k < 3; ++k) figures.rms[k] += e[k] * e[k], figures.bias[k] += e[k];
  }
  const auto n = static_cast<double>(std::max<std::size_t>(matches.size(), 1));
  figures.mean /= n;
  for (std::size_t k = 0; k < 3; ++k) figures.rms[k] = std::sqrt(figures.rms[k] / n), figures.bias[k] /= n;
  return figures;
}

}  // namespace rptv::testing
