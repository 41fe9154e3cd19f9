// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Replaces the sources in cgal/ in a build without CGAL.
#include "palpate/error.h"
#include "palpate/geometry/hole_filling.h"
#include "palpate/require.h"

namespace palpate::geometry {

FilledMesh fill_holes(const TriangleMesh&, const HoleFillingOptions& options) {
  require("HoleFillingOptions::max_diameter", options.max_diameter, above(0), "mm");
  throw Unavailable(
      "fill_holes needs CGAL, which this build of the library was made without; build it with "
      "-DPALPATE_CGAL=ON");
}

}  // namespace palpate::geometry
