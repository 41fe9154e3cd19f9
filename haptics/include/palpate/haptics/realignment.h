// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "palpate/probing/acquisition.h"

namespace palpate::haptics {

/// Pairs of displacement and force at one contact, what a force field is fitted to.
struct ForceSamples {
  Eigen::Matrix3Xd displacements;  ///< [mm] 3 x N, tool position minus contact position
  Eigen::Matrix3Xd forces;         ///< [N] 3 x N, of the tool on the object
};

/// Realigns the samples of one contact (thesis 5.2); world frame.
///
/// Within each group all tool positions `a` belong to the same normal force, so their mean m is the
/// best estimate of it: it makes one pair (m - c, component of the force along the normal). Every
/// sample that held makes a further pair (b - a + m - c, p). Of a sample that slipped only `a` is
/// used. Samples of other contacts are left out. Pairs come by ascending group, then in the order
/// of the samples.
[[nodiscard]] ForceSamples realign(const probing::Contact& contact,
                                   std::span<const probing::Sample> samples);

}  // namespace palpate::haptics
