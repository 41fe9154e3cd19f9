// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Replaces the sources in cgal/ in a build without CGAL.
#include <string>

#include "palpate/error.h"
#include "palpate/geometry/hole_filling.h"
#include "palpate/require.h"
#include "scans/poisson_surface.h"

namespace palpate::geometry {
namespace {

[[noreturn]] void refuse(const std::string& what) {
  throw Unavailable(what +
                    " needs CGAL, which this build of the library was made without; build it with "
                    "-DPALPATE_CGAL=ON");
}

}  // namespace

FilledMesh fill_holes(const TriangleMesh&, const HoleFillingOptions& options) {
  require("HoleFillingOptions::max_diameter", options.max_diameter, above(0), "mm");
  refuse("fill_holes");
}

TriangleMesh poisson_surface(const Eigen::Matrix3Xd&, const Eigen::Matrix3Xd&, double) {
  refuse("merge_scans");
}

}  // namespace palpate::geometry
