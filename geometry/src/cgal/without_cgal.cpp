// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Replaces the sources in cgal/ in a build without CGAL.
#include <string>

#include "palpate/core/error.h"
#include "palpate/geometry/hole_filling.h"
#include "palpate/geometry/self_intersection_removal.h"

namespace palpate::geometry {
namespace {

[[noreturn]] void refuse(const char* function) {
  throw Unavailable(std::string(function) +
                    " needs CGAL, which this build of the library was made without; build it with "
                    "-DPALPATE_CGAL=ON");
}

}  // namespace

FilledMesh fill_holes(const TriangleMesh&, const HoleFillingOptions& options) {
  check_hole_filling(options);
  refuse("fill_holes");
}

SelfIntersectionRemoval remove_self_intersections(const TriangleMesh&,
                                                  const SelfIntersectionRemovalOptions&) {
  refuse("remove_self_intersections");
}

}  // namespace palpate::geometry
