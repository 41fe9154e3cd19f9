// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "palpate/geometry/eigen_alignment.h"
#include "palpate/probing/acquisition.h"

namespace palpate::probing {

/// How stiff an object is at a contact: a normal force over the depth to which it presses the tip.
struct ContactStiffness {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [mm] of the contact
  double stiffness = 0;                                ///< [N/mm] > 0
  double deviation = 0;  ///< [N/mm] standard deviation by the noise of positions and forces; > 0
};

/// [N] The largest normal force that three quarters of the contacts with presses reach, so that
/// they can be compared under it; 0 if no contact has one.
[[nodiscard]] double common_press_force(const CheckedAcquisition& acquisition);

/// Noise of the presses. The meaning of each is that of `ProgramOptions`.
struct PressNoise {
  double position = 0.022;  ///< [mm] > 0
  double force = 0.01;      ///< [N] >= 0
};

/// Compares the contacts under one normal force, because objects stiffen and a ball's contact
/// grows. The depth at the force is the mean of the presses within 1 % of it, otherwise it lies on
/// the straight line between the presses next below and above it, no force at no depth included.
/// Drags count with the position before the drag. Contacts that were not pressed so hard, or gave
/// way less than twice the deviation of a depth, are left out.
/// \param force [N] \throws InvalidInput unless force and noise are in their ranges.
[[nodiscard]] std::vector<ContactStiffness> contact_stiffness(const CheckedAcquisition& acquisition,
                                                              double force,
                                                              const PressNoise& noise = {});

}  // namespace palpate::probing
