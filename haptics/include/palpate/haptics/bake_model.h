// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/haptics/build_model.h"
#include "palpate/probing/contact_plan.h"
#include "palpate/probing/specimen.h"

namespace palpate::haptics {

/// Plans the presses on a simulated object of which a model is computed without an arm:
/// `probing::plan_contacts` with levels from 5 % to 93 % of `max_force`. Above the highest there is
/// room for a tangential force; a model whose levels end lower has to guess more of what is above.
/// \throws InvalidInput as `probing::plan_contacts`.
[[nodiscard]] probing::ContactPlan plan_bake(const probing::Specimen& specimen,
                                             probing::PlanOptions options);

/// Options for `build_model` of the samples of `probing::try_specimen`, which have no noise.
/// \param max_force [N] > 0: the largest one of the plan
[[nodiscard]] BuildOptions exact_samples(double max_force);

}  // namespace palpate::haptics
