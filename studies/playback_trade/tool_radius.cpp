// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <cstdio>

#include "solids.h"
#include "tables.h"

namespace palpate::bench {
namespace {

constexpr double kProbe = 5;                              // [mm] radius of the probe's ball
constexpr std::array<double, 4> kRadii{2.5, 3.5, 7, 10};  // [mm] of other tools

void compare_radii(const TradeSolid& solid, double depth) {
  const Eigen::Vector3d place = Eigen::Vector3d::Zero();
  const auto probe = press(solid, place, {.radius = kProbe, .depth = depth});
  std::printf("| %s | %.1f | %.3f |", solid.name.c_str(), depth, probe.value_or(std::nan("")));
  for (const double radius : kRadii) {
    const auto force = press(solid, place, {.radius = radius, .depth = depth});
    if (!probe || !force) {
      std::printf(" none |");
      continue;
    }
    std::printf(" %.3f (%.2f) |", *force / *probe,
                std::log(*force / *probe) / std::log(radius / kProbe));
    std::fflush(stdout);
  }
  std::printf("\n");
}

}  // namespace

void print_tool_radii() {
  std::printf(
      "\nForce on a ball over that on the probe's ball of %.0f mm at the same depth, and the power "
      "of the radius that it follows\n\n| object | depth [mm] | force on the probe [N] |",
      kProbe);
  for (const double radius : kRadii) std::printf(" %.1f mm |", radius);
  std::printf("\n");
  for (const double height : {60.0, 20.0, 10.0}) {
    for (const double depth : {1.0, 2.5}) compare_radii(trade_block(height), depth);
  }
  for (const double depth : {5.0, 10.0}) compare_radii(trade_sheet(), depth);
}

}  // namespace palpate::bench
