// SPDX-License-Identifier: MIT
// The linker's cost is the least there is: against every possible linking of small random frames.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <set>

#include "tests/tracking/linking.hpp"

namespace rptv {
namespace {

/// `steps` per mm: few steps make ties, many make every distance different.
Positions3 some_positions(int steps, double side_mm, std::size_t most, int dimensions) {
  const auto count = *rc::gen::inRange<std::size_t>(0, most + 1);
  Positions3 positions(count, Position{0, 0, 0});
  for (Position& p : positions)
    for (int axis = 0; axis < dimensions; ++axis)
      p[static_cast<std::size_t>(axis)] =
          *rc::gen::inRange(0, static_cast<int>(side_mm * steps) + 1) / static_cast<double>(steps);
  return positions;
}

void expect_least_cost(const Positions3& sources, const Positions3& targets, double range) {
  LinkerSettings settings = settings_for(range);
  settings.max_particles = settings.max_tracks = 8;  // small, as there are tens of thousands of them
  Session session(settings);
  session.next(sources);
  const auto identities = session.next(targets);
  RC_ASSERT(identities.size() == targets.size());
  RC_ASSERT(std::set<std::uint64_t>(identities.begin(), identities.end()).size() == identities.size());
  for (std::size_t t = 0; t < targets.size(); ++t)
    if (identities[t] < sources.size())
      RC_ASSERT(squared_distance(sources[identities[t]], targets[t]) <= range * range * (1 + 1e-12));
  const double cost = cost_of_links(sources, targets, identities, range);
  RC_ASSERT(std::abs(cost - least_cost_by_trial(sources, targets, range)) < 1e-9);
}

RC_GTEST_PROP(Linker, costs_the_least_when_every_distance_differs, ()) {
  expect_least_cost(some_positions(1'000'000, 1, 6, 3), some_positions(1'000'000, 1, 6, 3),
                    *rc::gen::element(0.3, 0.5, 0.7, 1.0, 2.0));
}

RC_GTEST_PROP(Linker, costs_the_least_when_many_distances_are_equal, ()) {
  expect_least_cost(some_positions(2, 2, 6, 2), some_positions(2, 2, 6, 2), *rc::gen::element(0.5, 1.0, 1.2, 3.0));
}

RC_GTEST_PROP(Linker, costs_the_least_on_a_line, ()) {
  expect_least_cost(some_positions(10, 2, 7, 1), some_positions(10, 2, 6, 1), *rc::gen::element(0.1, 0.3, 1.0));
}

}  // namespace
}  // namespace rptv
