// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "objects.h"
#include "strategies.h"

namespace palpate::bench {

/// Forces where a plain Gaussian process over place and force has the largest variance, one after
/// the other: squared exponentials of 20 mm and of a third of the largest force, the same in all
/// directions. The candidates are random forces at the plan's contacts, within 0.9 of cones that
/// are known for nothing.
[[nodiscard]] std::vector<ChosenForce> choose_by_variance(const PreparedObject& object, int samples,
                                                          unsigned seed);

/// [N] 3 x M, forces at the queries by a plain Gaussian process over place and displacement, for
/// each component of the force by itself: a squared exponential with one length over places and one
/// over displacements, and noise as a share of the signal, chosen by the marginal likelihood of the
/// drags. It also takes the positions under normal forces alone, and no force without displacement
/// at each contact. It does not know that there is an energy.
[[nodiscard]] Eigen::Matrix3Xd predict_plainly(const probing::Acquisition& acquisition,
                                               const std::vector<probing::KnownForce>& queries);

}  // namespace palpate::bench
