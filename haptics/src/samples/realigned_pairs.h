// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "palpate/probing/acquisition.h"

namespace palpate::haptics {

/// A realigned pair of an acquisition. `settled` is the index of the pair of its group's normal
/// force, which is the mean of `repeats` positions and whose error moves the whole group.
struct Pair {
  std::size_t contact = 0;  ///< index among the contacts
  std::size_t settled = 0;  ///< index of a pair; its own for that pair
  int repeats = 1;          ///< of the settled pair
  /// [mm^2] sum over components of the variance of one position of the settled pair
  double scatter = 0;
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< [mm]
  Eigen::Vector3d force = Eigen::Vector3d::Zero();         ///< [N]
  /// [N] what the force is expected to be off, since the tool held (`expect_held`)
  Eigen::Vector3d held_error = Eigen::Vector3d::Zero();
  /// [mm] standard deviation of each component that the law which explains the pair is expected to
  /// be off; pairs of one contact share such errors
  double law_error = 0;
};

/// The realigned pairs of all contacts.
[[nodiscard]] std::vector<Pair> realigned_pairs(const probing::CheckedAcquisition& acquisition);

}  // namespace palpate::haptics
