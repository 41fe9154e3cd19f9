// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/core/fields.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// The meaning, unit and range of each field stand in its list, `visit`.
struct SmoothingOptions {
  int iterations = 20;
  double pass_band = 0.1;
  bool keep_border = false;
};

void visit(SmoothingOptions& options, FieldVisitor& visitor);

/// Share of the way to the mean of its neighbours that a vertex goes when the surface shrinks. From
/// 0.6 on, the shortest waves could grow.
inline constexpr double kSmoothingStep = 0.5;

/// Smooths a mesh without shrinking it (Taubin 1995).
///
/// With the mean m of its neighbours, each vertex x is moved by lambda (m - x), where lambda is
/// `kSmoothingStep`, and then by mu (m - x), where 1 / lambda + 1 / mu = pass_band and hence mu <
/// -lambda. A wave of frequency k (eigenvalue of I - mean) is multiplied by (1 - lambda k) (1 - mu
/// k), which exceeds 1 only slightly below the pass band. Neighbours have equal weights, so
/// vertices also spread evenly. A border vertex uses only its neighbours on the border.
/// \throws InvalidInput if an option is outside its range, or as `opposite_half_edges`.
[[nodiscard]] TriangleMesh smooth(const TriangleMesh& mesh, const SmoothingOptions& options = {});

}  // namespace palpate::geometry
