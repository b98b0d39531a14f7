// SPDX-License-Identifier: MIT
// Runs, components, centres and parts of blobs against plain oracles, bit for bit, with every instruction set.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "reconstruct/detection/detector.hpp"
#include "reconstruct/detection/lit_components.hpp"
#include "reconstruct/detection/lit_maxima.hpp"
#include "tests/core/instruction_sets.hpp"
#include "tests/reconstruct/random_image.hpp"

namespace rptv {
namespace {

using testing::RandomImage;
using Pixels = std::vector<PixelIndex>;

// All pixels of `inside` that are connected with the first one, over edges and corners, by a flood.
Pixels flood(std::set<std::pair<int, int>>& inside) {
  Pixels found;
  std::vector<std::pair<int, int>> front{*inside.begin()};
  inside.erase(inside.begin());
  while (!front.empty()) {
    const auto [y, x] = front.back();
    front.pop_back();
    found.push_back({x, y});
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx)
        if (inside.erase({y + dy, x + dx}) != 0) front.emplace_back(y + dy, x + dx);
  }
  return found;
}

std::vector<Pixels> plain_components(const RandomImage& image, std::uint16_t limit) {
  std::set<std::pair<int, int>> lit;  // in raster order
  for (int y = 0; y < static_cast<int>(image.shape.height_px); ++y)
    for (int x = 0; x < static_cast<int>(image.shape.width_px); ++x)
      if (image.at(x, y) > limit) lit.insert({y, x});
  std::vector<Pixels> components;
  while (!lit.empty()) components.push_back(flood(lit));
  return components;
}

RC_GTEST_PROP(LitComponents, are_those_of_a_plain_flood_with_every_instruction_set, ()) {
  const RandomImage image = testing::any_image(*rc::gen::element(6U, 40U, 140U));
  const auto threshold = *rc::gen::element<std::uint16_t>(0, 100, 250);
  const auto expected = plain_components(image, threshold);
  for (const auto set : testing::sets_here()) {
    std::vector<LitRun> runs;
    runs.reserve(image.shape.pixels());
    const std::size_t count = find_lit_runs(image.view(), DarkLimit(image.shape, 0, threshold), runs, set);
    RC_ASSERT(count == runs.size());
    LitComponents components(runs.size());
    components.join(runs);
    RC_ASSERT(components.size() == expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      std::set<std::pair<int, int>> pixels, wanted;
      for (const LitRun& run : components[i])
        for (std::uint32_t x = run.first_x; x < run.end_x; ++x)
          RC_ASSERT(pixels.insert({static_cast<int>(run.y), static_cast<int>(x)}).second);
      for (const auto& p : expected[i]) wanted.insert({p.y, p.x});
      RC_ASSERT(pixels == wanted);
    }
  }
}

RC_GTEST_PROP(LitRuns, beyond_the_room_are_counted, ()) {
  const RandomImage image = testing::any_image(140);
  const DarkLimit limit(image.shape, 0, 0);
  std::vector<LitRun> all, some;
  all.reserve(image.shape.pixels());
  find_lit_runs(image.view(), limit, all, InstructionSet::portable);
  const std::size_t room = all.size() / 2;
  for (const auto set : testing::sets_here()) {
    std::vector<LitRun> fresh;
    fresh.reserve(room);
    RC_ASSERT(find_lit_runs(image.view(), limit, fresh, set) == all.size());
    RC_ASSERT(fresh == std::vector<LitRun>(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(fresh.size())));
    RC_ASSERT(fresh.size() >= room);
  }
}

// The centre of light over the limit, by sums over the pixels of each component in any order.
RC_GTEST_PROP(Blobs, have_the_centres_of_plain_sums_bit_for_bit, ()) {
  const RandomImage image = testing::any_image(60);
  DetectorSettings settings;
  settings.method = "blob", settings.threshold = 100, settings.threshold_sigmas = 0;
  settings.min_area_px = 1, settings.split_sigmas = 1000, settings.noise_grey = 1e4;  // nothing is split
  settings.max_detections = settings.max_area_px = 4096;
  std::map<std::pair<double, double>, double> expected;
  for (const auto& component : plain_components(image, 100)) {
    double light = 0, x = 0, y = 0, area = 0;
    bool at_border = false;
    const auto& origin = *std::min_element(component.begin(), component.end(), [](const auto& a, const auto& b) {
      return std::pair(a.y, a.x) < std::pair(b.y, b.x);
    });
    for (const auto& p : component) {
      const double over = image.at(p.x, p.y) - 100;
      light += over, x += over * (p.x - origin.x), y += over * (p.y - origin.y), ++area;
      at_border |= p.x == 0 || p.y == 0 || p.x + 1 == static_cast<int>(image.shape.width_px) ||
                   p.y + 1 == static_cast<int>(image.shape.height_px);
    }
    if (!at_border) expected[{origin.x + x / light, origin.y + y / light}] = area;
  }
  for (const auto set : testing::sets_here()) {
    Detector detector(settings, image.shape, {}, 0, set);
    Detections found(4096);
    detector.detect(image.view(), found);
    std::map<std::pair<double, double>, double> blobs;
    for (std::size_t i = 0; i < found.size(); ++i) blobs[{found.x_px[i], found.y_px[i]}] = found.area_px[i];
    RC_ASSERT(blobs == expected);
  }
}

// How far the grey falls from each maximum before its surroundings hold a higher one: by floods at every grey value.
std::size_t plain_parts(const RandomImage& image, int limit, double depth) {
  std::size_t parts = 0;
  for (const auto& component : plain_components(image, static_cast<std::uint16_t>(limit))) {
    std::map<int, std::set<std::pair<int, int>>> by_grey;
    for (const auto& p : component) by_grey[image.at(p.x, p.y)].insert({p.y, p.x});
    std::vector<std::pair<int, Pixels>> peaks;  // plateaus without a higher neighbour
    for (const auto& [grey, pixels] : by_grey) {
      auto level = pixels;
      while (!level.empty()) {
        const Pixels plateau = flood(level);
        bool has_higher = false;
        for (const auto& p : plateau)
          for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx)
              if (const int x = p.x + dx, y = p.y + dy; x >= 0 && y >= 0 &&
                                                        x < static_cast<int>(image.shape.width_px) &&
                                                        y < static_cast<int>(image.shape.height_px))
                has_higher |= image.at(x, y) > grey;
        if (!has_higher) peaks.emplace_back(grey, plateau);
      }
    }
    for (const auto& [grey, plateau] : peaks) {
      const auto first = [](const Pixels& pixels) {
        std::pair<int, int> least{1 << 30, 0};
        for (const auto& p : pixels) least = std::min(least, {p.y, p.x});
        return least;
      };
      double persistence = 1e9;  // of the highest one
      for (auto lower = by_grey.rbegin(); lower != by_grey.rend() && persistence == 1e9; ++lower) {
        if (lower->first > grey) continue;
        std::set<std::pair<int, int>> level;
        for (const auto& [value, pixels] : by_grey)
          if (value >= lower->first) level.insert(pixels.begin(), pixels.end());
        while (!level.empty()) {
          const Pixels around = flood(level);
          std::set<std::pair<int, int>> set;
          for (const auto& p : around) set.insert({p.y, p.x});
          if (set.count(first(plateau)) == 0) continue;
          for (const auto& [other, other_plateau] : peaks)
            if (set.count(first(other_plateau)) != 0 &&
                (other > grey || (other == grey && first(other_plateau) < first(plateau))))
              persistence = grey - lower->first;
        }
      }
      parts += persistence > depth;
    }
  }
  return parts;
}

RC_GTEST_PROP(Blobs, are_as_many_as_there_are_maxima_that_persist, ()) {
  RandomImage image = testing::any_image(9);
  for (auto& byte : image.bytes) byte = static_cast<std::byte>(static_cast<unsigned>(byte) % 8 + 10);
  image.shape.bytes_per_pixel = 1;
  RandomImage framed{{image.shape.width_px + 2, image.shape.height_px + 2, 1}, {}};  // nothing lit at the border
  framed.bytes.resize(framed.shape.bytes());
  for (int y = 0; y < static_cast<int>(image.shape.height_px); ++y)
    for (int x = 0; x < static_cast<int>(image.shape.width_px); ++x) framed.set(x + 1, y + 1, image.at(x, y));
  const int limit = *rc::gen::inRange(9, 14);
  DetectorSettings settings;
  settings.method = "blob", settings.threshold = limit, settings.threshold_sigmas = 0, settings.min_area_px = 1;
  settings.noise_grey = 1, settings.electrons_per_grey = 1e6;
  settings.max_detections = settings.max_area_px = 256;
  settings.split_sigmas = *rc::gen::element(0.0, 1.0, 2.0, 3.0);
  Detector detector(settings, framed.shape);
  Detections found(4096);
  detector.detect(framed.view(), found);
  RC_ASSERT(found.size() == plain_parts(framed, limit, settings.split_sigmas * std::sqrt(1 + 1.0 / 12)));
}

}  // namespace
}  // namespace rptv
