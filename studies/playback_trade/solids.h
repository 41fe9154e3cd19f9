// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "palpate/probing/contact_equilibrium.h"

namespace palpate::bench {

// A solid whose upper side is z = 0 and faces -z.
struct TradeSolid {
  std::string name;
  probing::DeformableBody body;
};
// A block on a table, of cells that are finest along the x axis.
[[nodiscard]] TradeSolid trade_block(double height);
// A sheet of 100 x 60 x 2 mm, stretched by a tenth along x and held at both ends.
[[nodiscard]] TradeSolid trade_sheet();

struct PressOptions {
  double radius = 5;                          // [mm] of the balls, which have no friction
  double depth = 0;                           // [mm] of the tool, and of the other one
  std::optional<Eigen::Vector3d> other = {};  // [mm] where another ball presses
};
// [N] along z on a ball that presses at `place` [mm]; nothing if there is no equilibrium.
[[nodiscard]] std::optional<double> press(const TradeSolid& solid, const Eigen::Vector3d& place,
                                          const PressOptions& options);

}  // namespace palpate::bench
