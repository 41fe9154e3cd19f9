// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/geometry/hole_filling.h"

namespace palpate::geometry {

/// What fill_holes answers. Pre: options are checked.
/// \throws as fill_holes does.
[[nodiscard]] FilledMesh add_hole_patches(const TriangleMesh& mesh, double max_diameter);

}  // namespace palpate::geometry
