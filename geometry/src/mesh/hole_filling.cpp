// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/hole_filling.h"

#include "mesh/hole_patches.h"
#include "palpate/require.h"

namespace palpate::geometry {

FilledMesh fill_holes(const TriangleMesh& mesh, const HoleFillingOptions& options) {
  require("HoleFillingOptions::max_diameter", options.max_diameter, above(0), "mm");
  return add_hole_patches(mesh, options.max_diameter);
}

}  // namespace palpate::geometry
