// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "finite_elements/contact_system.h"

namespace palpate::probing {

// 3 x N [mm]: the nodes without the tip, after supports have moved and obstacles have pushed.
// Throws SolverError if there is no equilibrium.
[[nodiscard]] Eigen::Matrix3Xd rest_equilibrium(const DeformableBody& body,
                                                const ContactSystem& system,
                                                const EquilibriumOptions& options);

}  // namespace palpate::probing
