// SPDX-License-Identifier: MIT
// A settings struct with a field of every kind and a section.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/settings.hpp"

namespace rptv {

struct Lens {
  double focal_length_mm = 50;
  std::vector<double> centre_mm = {1, 2};
  void fields(FieldList& list) {
    list.number("focal_length_mm", focal_length_mm, 1e-3, 1e4, "of the main lens, mm");
    list.numbers("centre_mm", centre_mm, 2, -100, 100, "where the axis meets the array, mm");
  }
};

struct Rig {
  std::string name = "rig";
  std::string policy = "newest";
  std::int64_t memory = 3;
  bool loop = false;
  double rate_hz = 100;
  std::vector<double> weights;
  std::vector<std::string> hosts;
  Lens lens;
  void fields(FieldList& list) {
    list.text("name", name, "of the rig");
    list.choice("policy", policy, {"newest", "lossless"}, "what to do when behind");
    list.integer("memory", memory, 0, 100, "frames that a particle may be unseen");
    list.flag("loop", loop, "begin again at the end");
    list.number("rate_hz", rate_hz, 0, 1e6, "frames per second");
    list.numbers("weights", weights, 0, -1e300, 1e300, "any number of them");
    list.texts("hosts", hosts, "where it is seen");
    list.section("lens", lens);
  }
};

/// Throws what read_toml_text throws; messages call the text rig.toml.
inline void read(Rig& rig, std::string_view text) {
  FieldList list;
  rig.fields(list);
  read_toml_text(text, "rig.toml", "configuration", 1, list);
}

}  // namespace rptv
