// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "blocks.h"
#include "palpate/probing/contact_stiffness.h"

namespace palpate::bench {

inline constexpr double kPressForce = 0.5;  // [N]

/// Depths of presses at 9 x 9 places, 4 mm apart and 8 mm or more from the border, under
/// `kPressForce`.
struct PressTable {
  Eigen::Matrix3Xd places;  ///< [mm]
  Eigen::VectorXd depths;   ///< [mm] without noise
};
[[nodiscard]] PressTable press_everywhere(const InclusionBlock& block);

/// Called with what is known after a number of presses.
using AfterPresses =
    std::function<void(int presses, const std::vector<probing::ContactStiffness>& known)>;

/// All places at once, without noise: what a map of this tip can show at best.
void press_exactly(const PressTable& table, const AfterPresses& after);
/// Square grids of 3 x 3 to 9 x 9 places, each pressed from the start.
void press_grids(const PressTable& table, unsigned seed, const AfterPresses& after);
/// One place after the other, the farthest from all before.
void press_farthest(const PressTable& table, unsigned seed, int most, const AfterPresses& after);
/// Plain Bayesian optimisation: five places of `press_farthest`, then where the upper confidence
/// bound of the logarithm of the stiffness, mean + 2 deviations, is highest.
void press_by_bound(const PressTable& table, unsigned seed, int most, const AfterPresses& after);
/// The strategy `adaptive` with one direction of drags, until `most` trials; `after` each contact.
void press_adaptively(const InclusionBlock& block, unsigned seed, int most,
                      const AfterPresses& after);

}  // namespace palpate::bench
