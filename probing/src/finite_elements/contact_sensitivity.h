// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "finite_elements/contact_newton.h"

namespace palpate::probing {

// Motions of all nodes and of the tip, one after the other [mm], by which the equilibrium `at`
// answers small forces; a column of `forces` holds 3 N on nodes, then 3 on the tip [N]. Contacts
// follow the way from `start`. The factors are replaced by those at the equilibrium if they are too
// old for the linear systems.
// Throws SolverError if the equilibrium is not stable.
[[nodiscard]] Eigen::MatrixXd answers_to(const ContactSystem& system,
                                         const EquilibriumOptions& options,
                                         const PlaceFactors& place, WorkingFactors& working,
                                         const ContactState& start, const ContactState& at,
                                         const Eigen::MatrixXd& forces);

}  // namespace palpate::probing
