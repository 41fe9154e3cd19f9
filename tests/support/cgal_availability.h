// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/core/error.h"
#include "palpate/geometry/hole_filling.h"

namespace palpate::geometry::test {

/// Returns true if the library was built with CGAL. Tests that need it are skipped without.
inline bool has_cgal() {
  const TriangleMesh triangle{.vertices = Eigen::Matrix3d::Identity(),
                              .triangles = Eigen::Vector3i(0, 1, 2)};
  try {
    static_cast<void>(fill_holes(triangle, {.max_diameter = 1}));
    return true;
  } catch (const Unavailable&) {
    return false;
  }
}

}  // namespace palpate::geometry::test
