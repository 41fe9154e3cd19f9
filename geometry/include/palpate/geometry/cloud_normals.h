// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <functional>

#include "palpate/core/fields.h"
#include "palpate/geometry/eigen_alignment.h"

namespace palpate::geometry {

/// The meaning, unit and range of each field that users set stand in its list, `visit`.
struct CloudNormalOptions {
  int neighbours = 16;
  /// [mm] Positions from which the points were seen: normals point towards them. 3 x 0: unknown;
  /// 3 x 1: one for all points; 3 x N: one for each point.
  Eigen::Matrix3Xd viewpoints = {};
  /// Called in the calling thread after each part of the points; the last call has done == total.
  /// If it throws, the work ends.
  std::function<void(int done, int total)> progress = {};
};

void visit(CloudNormalOptions& options, FieldVisitor& visitor);

struct CloudNormals {
  Eigen::Matrix3Xd normals;  ///< 3 x N, unit length; NaN where unknown
  /// Points without a normal: those that are not finite, and those whose neighbours lie on a line
  /// or in one place (within 1e-6 of their extent).
  int unknown = 0;
};

/// Normals of a cloud of points (3 x N [mm]) on a surface: normals of the planes of least squares
/// of their nearest neighbours (Hoppe et al. 1992), in double precision.
///
/// Without viewpoints neighbours get the same side along the minimum spanning tree of their
/// differences in direction, 1 - |n_i . n_j|. Each connected part is turned so that its normals
/// point away from its centroid on average: outwards if the part is closed, to the convex side of a
/// part that is curved one way. A flat part has no outside; it gets one of both sides. Sheets
/// nearer to each other than neighbours are may get the wrong side.
///
/// The result does not depend on the number of threads; it turns with the frame and, unless points
/// are equally far from one, does not depend on the order of the points (up to rounding).
/// \throws InvalidInput if an option is outside its range, a viewpoint is not finite, or there are
/// neither 0, 1 nor N of them.
[[nodiscard]] CloudNormals cloud_normals(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                         const CloudNormalOptions& options = {});

}  // namespace palpate::geometry
