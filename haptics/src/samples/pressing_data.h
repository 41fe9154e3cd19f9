// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "palpate/haptics/pressing_estimate.h"
#include "samples/pressing_statistics.h"

namespace palpate::haptics {

/// The measurements of a contact, along and across its direction.
struct Press {
  Eigen::VectorXd depth, force;  // [mm], [N]
  Eigen::Vector3d across_slope;  // mm across per mm of depth
  Eigen::Vector3d across_force;  // [N] mean force across
  Eigen::VectorXd weight;        // of the object's force: 1, or 1 - hysteresis
};

/// Values that all contacts share while an acquisition is estimated.
struct Scales {
  double length = 1;   // [mm] the largest depth
  double force = 1;    // [N] root mean square
  int depths = 1;      // how many different depths most contacts have
  bool along = false;  // forces were recorded along the pressing only
};

/// Forces count as recorded along one direction only if what is across is, in root mean square,
/// below this share of what is along.
inline constexpr double kAlongOnly = 1e-3;

/// \throws InvalidInput naming the contact if it is no measurement.
void check_pressed(const PressedContact& contact, std::size_t index);

[[nodiscard]] std::vector<Press> presses_of(std::span<const PressedContact> contacts);
[[nodiscard]] Scales scales_of(std::span<const PressedContact> contacts,
                               const std::vector<Press>& presses);
[[nodiscard]] std::vector<CompressedPress> compressed(std::span<const PressedContact> contacts,
                                                      const std::vector<Press>& presses,
                                                      const Scales& scales, int degree);

}  // namespace palpate::haptics
