// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "identify/parameter_search.h"
#include "palpate/haptics/friction_cone.h"
#include "palpate/haptics/identify.h"
#include "palpate/probing/acquisition.h"

namespace palpate::haptics {

/// The friction cone of each contact, with stop `not_converged` where there is no trial.
[[nodiscard]] std::vector<FrictionFit> friction_cones(
    const probing::CheckedAcquisition& acquisition, const IdentifyOptions& options);

/// Sets `Pair::held_error`. Forces vary about those that were commanded, and near the friction
/// boundary a tool holds only if its force happened to be inside: in the mean, such a sample
/// belongs to a force further inside, by the mean of the normal distribution that the boundary cuts
/// off. Boundary and noise are those of the contact's cone, where it is determined.
void expect_held(const std::vector<FrictionFit>& cones, std::vector<Pair>& pairs);

/// The same law with one more parameter, in [0, 1]: the share of `Pair::held_error` that acts on
/// the displacement. An error of the force that is there before the drag moves both positions of a
/// sample, and does not act.
[[nodiscard]] ParametricLaw with_held_share(const ParametricLaw& law);

}  // namespace palpate::haptics
