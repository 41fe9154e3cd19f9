// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

struct SmoothingOptions {
  int iterations = 20;       ///< >= 0; each one shrinks by lambda and inflates by mu
  double lambda = 0.5;       ///< in (0, 0.6]; for larger values the shortest waves grow
  double pass_band = 0.1;    ///< in (0, 1); lower frequencies are kept. The highest frequency is 2
  bool keep_border = false;  ///< keep the border fixed; otherwise smooth it along itself
};

/// Smooths a mesh without shrinking it (Taubin 1995).
///
/// With the mean m of its neighbours, each vertex x is moved by lambda (m - x) and then by
/// mu (m - x), where 1 / lambda + 1 / mu = pass_band and hence mu < -lambda. A wave of frequency k
/// (eigenvalue of I - mean) is multiplied by (1 - lambda k) (1 - mu k), which exceeds 1 only
/// slightly below the pass band. Neighbours have equal weights, so vertices also spread evenly. A
/// border vertex uses only its neighbours on the border.
/// \throws InvalidInput if an option is outside its range, or as `opposite_half_edges`.
[[nodiscard]] TriangleMesh smooth(const TriangleMesh& mesh, const SmoothingOptions& options = {});

}  // namespace palpate::geometry
