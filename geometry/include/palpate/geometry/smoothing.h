// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

struct SmoothingOptions {
  int iterations = 20;       ///< >= 0; each shrinks by lambda and swells by mu
  double lambda = 0.5;       ///< in (0, 0.6]; beyond it, the shortest waves would soon grow
  double pass_band = 0.1;    ///< in (0, 1); lower frequencies stay. The shortest waves have 2
  bool keep_border = false;  ///< the border stays as it is; otherwise it is smoothed along itself
};

/// Smooths without shrinking (Taubin 1995): each iteration moves every vertex towards the mean m of
/// its neighbours, x += lambda (m - x), and then away, x += mu (m - x), with
/// 1 / lambda + 1 / mu = pass_band, hence mu < -lambda. A wave of frequency k (the eigenvalues of I
/// - mean) is multiplied by (1 - lambda k) (1 - mu k): at most a little above 1 below the pass
/// band. Neighbours count alike, so that vertices also spread evenly; those of a vertex at the
/// border are its neighbours there. \throws InvalidInput on an option outside its range, or as
/// `opposite_half_edges`.
[[nodiscard]] TriangleMesh smooth(const TriangleMesh& mesh, const SmoothingOptions& options = {});

}  // namespace palpate::geometry
