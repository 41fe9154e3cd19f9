// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include "palpate/core/error.h"
#include "solid_meshes.h"
#include "solids.h"

namespace palpate::bench {
namespace {

using Eigen::Vector3d;

// Coordinates on both sides of zero.
std::vector<double> mirrored(const std::vector<double>& positive) {
  std::vector<double> all;
  for (auto value = positive.rbegin(); value != positive.rend(); ++value) all.push_back(-*value);
  all.push_back(0);
  all.insert(all.end(), positive.begin(), positive.end());
  return all;
}

}  // namespace

TradeSolid trade_block(double height) {
  TradeSolid solid{.name = "block, " + std::to_string(static_cast<int>(height)) + " mm high",
                   .body = {}};
  std::vector<double> z{0, 4};
  while (z.back() < height) z.push_back(std::min(height, 2.5 * z.back()));
  solid.body.mesh =
      probing::box_mesh(mirrored({4, 8, 12, 16, 20, 24, 32, 44, 60}), mirrored({4, 8, 16, 36}), z);
  solid.body.materials = {{.shear_modulus = 0.03, .bulk_modulus = 0.3}};
  support::support_where(solid.body, [&](const Vector3d& at) { return at.z() == height; });
  return solid;
}

TradeSolid trade_sheet() {
  TradeSolid solid{.name = "stretched sheet", .body = {}};
  solid.body.mesh =
      probing::box_mesh(support::evenly(-50, 50, 20), support::evenly(-30, 30, 12), {0, 2});
  solid.body.materials = {{.shear_modulus = 0.2, .bulk_modulus = 4}};
  support::support_where(solid.body, [](const Vector3d& at) { return std::abs(at.x()) == 50; });
  support::move_supports(
      solid.body, [](const Vector3d& at) { return Vector3d(std::copysign(5, at.x()), 0, 0); });
  return solid;
}

// The other ball stands still, where it touches the object at first; the object's supports carry it
// against that ball by the depth, and the tool is moved with it.
std::optional<double> press(const TradeSolid& solid, const Vector3d& place,
                            const PressOptions& options) {
  constexpr double kWay = 0.5;      // [radii] of the tip in a load step, or it passes elements
  constexpr double kInside = 1e-9;  // [mm] by which rounding may make the box of a ball smaller
  const Vector3d inward = Vector3d::UnitZ();
  probing::DeformableBody body = solid.body;
  Vector3d shift = Vector3d::Zero();
  if (options.other) {
    const Vector3d centre = *options.other - options.radius * inward;
    const Vector3d half = Vector3d::Constant(options.radius);
    body.obstacles.push_back({centre - half, centre + half, options.radius - kInside});
    shift = -options.depth * inward;
    if (body.support_moves.size() == 0)
      body.support_moves.setZero(3, static_cast<Eigen::Index>(body.supported.size()));
    body.support_moves.colwise() += shift;
  }
  try {
    const int steps = static_cast<int>(std::ceil(options.depth / (kWay * options.radius)));
    const probing::ContactEquilibrium equilibrium(std::move(body),
                                                  {.tip_radius = options.radius,
                                                   .friction = 0,
                                                   .load_steps = std::max(steps, 1),
                                                   .max_halvings = 6});
    const Vector3d start = place + shift - options.radius * inward;
    probing::ContactState state = equilibrium.touch(place + shift, inward);
    const probing::ContactResult pressed =
        equilibrium.move_tip(state, start + options.depth * inward);
    if (pressed.stop != probing::ContactStop::converged) {
      std::printf("  %s: %s\n", solid.name.c_str(), to_string(pressed.stop));
      return std::nullopt;
    }
    return pressed.state.force.dot(inward);
  } catch (const Error& error) {
    std::printf("  %s: %s\n", solid.name.c_str(), error.what());
    return std::nullopt;
  }
}

}  // namespace palpate::bench
