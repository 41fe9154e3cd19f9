// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
//
// How soon a stiff inclusion below the surface of a soft block is found, and how well the contour
// of a stiffness map shows its outline: prints the tables of docs/probing.md. Takes minutes.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <iostream>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "blocks.h"
#include "palpate/core/quantile.h"
#include "palpate/probing/stiffness_map.h"
#include "strategies.h"

namespace palpate::bench {
namespace {

constexpr unsigned kSeeds = 10;
constexpr int kMostPresses = 60, kMostTrials = 100;
constexpr int kFewestForMap = 5;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The figures that research on palpation reports.
struct Score {
  bool found = false;  ///< a press within each part of the inclusion is inside the contour
  double overlap = 0;  ///< area of intersection over that of union; 0 without a contour
  double hausdorff = kInfinity;  ///< [mm] between outline and contour
};

double farthest_of(const Eigen::Matrix2Xd& from, const Eigen::Matrix2Xd& to) {
  double most = 0;
  for (const auto& point : from.colwise())
    most = std::max(most, (to.colwise() - point).colwise().norm().minCoeff());
  return most;
}

Score score(const InclusionBlock& block, const geometry::TriangleMesh& side,
            const std::vector<probing::ContactStiffness>& known) {
  Score result;
  const probing::StiffnessMap map = probing::stiffness_map(side, known);
  if (!map.distinct || map.contour.cols() == 0) return result;
  int both = 0, either = 0;
  for (Eigen::Index i = 0; i < side.vertices.cols(); ++i) {
    const bool truth = block.part_at(side.vertices(0, i), side.vertices(1, i)) > 0;
    const bool said = map.stiffness(i) >= map.threshold;  // false if unknown
    both += truth && said ? 1 : 0;
    either += truth || said ? 1 : 0;
  }
  result.overlap = static_cast<double>(both) / either;
  const Eigen::Matrix2Xd contour = map.contour.topRows<2>(), outline = block.outline();
  result.hausdorff = std::max(farthest_of(contour, outline), farthest_of(outline, contour));
  std::set<int> parts;
  for (const probing::ContactStiffness& one : known) {
    if (one.stiffness >= map.threshold)
      parts.insert(block.part_at(one.position.x(), one.position.y()));
  }
  parts.erase(0);
  result.found = static_cast<int>(parts.size()) == block.parts;
  return result;
}

/// Of one strategy on one block, by the number of presses; one score for each seed.
using Scores = std::map<int, std::vector<Score>>;

template <typename Run>
Scores scores_of(const InclusionBlock& block, const geometry::TriangleMesh& side, unsigned seeds,
                 const Run& run) {
  Scores scores;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    run(seed, [&](int presses, const std::vector<probing::ContactStiffness>& known) {
      if (static_cast<int>(known.size()) < kFewestForMap) return;
      scores[presses].push_back(score(block, side, known));
    });
  }
  return scores;
}

/// The number of presses from which on most seeds have found the inclusion.
std::string found_after(const Scores& scores) {
  std::string after = "not";
  for (auto at = scores.rbegin(); at != scores.rend(); ++at) {
    const auto found = std::count_if(at->second.begin(), at->second.end(),
                                     [](const Score& each) { return each.found; });
    if (2 * found <= static_cast<long>(at->second.size())) break;
    after = std::to_string(at->first);
  }
  return after;
}

/// Medians over the seeds at the largest number of presses that is at most `presses`.
std::string contour_error(const Scores& scores, int presses) {
  const auto after = scores.upper_bound(presses);
  if (after == scores.begin()) return "-";
  std::vector<double> overlaps, distances;
  for (const Score& each : std::prev(after)->second) {
    overlaps.push_back(each.overlap);
    distances.push_back(each.hausdorff);
  }
  return fmt::format("{:.2f}, {:.1f}", median(overlaps), median(distances));
}

void run() {
  const geometry::TriangleMesh side = upper_side();
  const std::vector<std::string> strategies{"every place, no noise", "grid", "farthest point",
                                            "Bayesian optimisation", "adaptive"};
  std::map<std::string, std::vector<Scores>> all;
  for (const InclusionBlock& block : inclusion_blocks()) {
    const PressTable table = press_everywhere(block);
    fmt::print("{}: depths {:.2f} to {:.2f} mm\n", block.name, table.depths.minCoeff(),
               table.depths.maxCoeff());
    all[strategies[0]].push_back(scores_of(
        block, side, 1, [&](unsigned, const AfterPresses& after) { press_exactly(table, after); }));
    all[strategies[1]].push_back(scores_of(
        block, side, kSeeds,
        [&](unsigned seed, const AfterPresses& after) { press_grids(table, seed, after); }));
    all[strategies[2]].push_back(
        scores_of(block, side, kSeeds, [&](unsigned seed, const AfterPresses& after) {
          press_farthest(table, seed, kMostPresses, after);
        }));
    all[strategies[3]].push_back(
        scores_of(block, side, kSeeds, [&](unsigned seed, const AfterPresses& after) {
          press_by_bound(table, seed, kMostPresses, after);
        }));
    all[strategies[4]].push_back(
        scores_of(block, side, 1, [&](unsigned seed, const AfterPresses& after) {
          press_adaptively(block, seed, kMostTrials, after);
        }));
    std::fflush(stdout);
  }
  fmt::print("\npresses until found\n");
  for (const std::string& name : strategies) {
    fmt::print("| {} |", name);
    for (const Scores& scores : all[name]) fmt::print(" {} |", found_after(scores));
    fmt::print("\n");
  }
  for (const int presses : {16, 25, 36, 49, 100}) {
    fmt::print("\nafter {} presses: overlap, Hausdorff distance [mm]\n", presses);
    for (const std::string& name : strategies) {
      fmt::print("| {} |", name);
      for (const Scores& scores : all[name]) fmt::print(" {} |", contour_error(scores, presses));
      fmt::print("\n");
    }
  }
}

}  // namespace
}  // namespace palpate::bench

int main() try {
  constexpr std::size_t kThreads = 2;
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, kThreads);
  palpate::bench::run();
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
