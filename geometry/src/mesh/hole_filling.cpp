// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/hole_filling.h"

#include <string>

#include "mesh/hole_patches.h"
#include "palpate/error.h"

namespace palpate::geometry {

FilledMesh fill_holes(const TriangleMesh& mesh, const HoleFillingOptions& options) {
  if (!(options.max_diameter > 0)) {
    throw InvalidInput("fill_holes: max_diameter is " + std::to_string(options.max_diameter) +
                       "; holes to fill are at most that wide, in mm, so it must be > 0");
  }
  return add_hole_patches(mesh, options.max_diameter);
}

}  // namespace palpate::geometry
