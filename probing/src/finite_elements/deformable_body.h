// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/probing/contact_equilibrium.h"

namespace palpate::probing {

// Throws InvalidInput if the mesh is not valid, a region has no material, a part of the solid can
// move freely, or an obstacle is not a block.
void check_deformable_body(const DeformableBody& body);

// [N/mm^2] the largest Young's modulus of the materials, at small strains.
[[nodiscard]] double largest_modulus(const DeformableBody& body);

}  // namespace palpate::probing
