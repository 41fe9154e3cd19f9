// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "random_paths.h"
#include "report.h"
#include "validation.h"

namespace palpate::bench {

void count_random_paths() {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  constexpr unsigned kPaths = 1000;
  constexpr int kPoints = 4;  // of a path
  struct Case {
    support::PathSolid object;
    double friction;
    unsigned paths;
  };
  const std::vector<Case> cases{{support::path_block(10, 5, 2), kInfinite, 250},
                                {support::path_block(10, 5, 2), 0.6, 250},
                                {support::path_block(1000, 5, 2), kInfinite, 250},
                                {support::path_sheet(10, 6), kInfinite, 150},
                                {support::path_sheet(10, 6), 0.6, 100}};
  std::printf("\nRandom paths of a tip of 5 mm: %u, of %d points each\n", kPaths, kPoints);
  unsigned seed = 0;
  for (const Case& one : cases) {
    const probing::ContactEquilibrium solid(one.object.body, {.friction = one.friction});
    support::PathCounts counts;
    for (unsigned i = 0; i < one.paths; ++i)
      support::follow_random_path(one.object, solid, seed++, kPoints, counts);
    std::printf("%s, friction %g: %d paths, %d converged, %d equilibria, deepest %.1f mm\n",
                one.object.name.c_str(), one.friction, counts.paths, counts.converged,
                counts.points, counts.deepest);
    for (const auto& [name, count] : counts.stops)
      std::printf("  ended, '%s': %d\n", name.c_str(), count);
    for (const auto& [name, count] : counts.refused)
      std::printf("  refused, '%s': %d\n", name.c_str(), count);
    for (const std::string& what : counts.broken) std::printf("  BROKEN: %s\n", what.c_str());
    std::fflush(stdout);
  }
}

}  // namespace palpate::bench
