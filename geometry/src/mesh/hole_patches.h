// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/geometry/hole_filling.h"

namespace palpate::geometry {

/// Implements `fill_holes`. Precondition: the options are valid.
/// \throws as `fill_holes`.
[[nodiscard]] FilledMesh add_hole_patches(const TriangleMesh& mesh, double max_diameter);

}  // namespace palpate::geometry
