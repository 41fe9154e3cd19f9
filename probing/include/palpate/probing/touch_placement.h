// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

#include "palpate/core/fields.h"
#include "palpate/geometry/triangle_mesh.h"
#include "palpate/probing/arm_placement.h"

namespace palpate::probing {

/// `visit` describes the fields.
struct TouchPlacementOptions {
  /// A rough pose; none: the surface is searched for the touches everywhere, in all orientations.
  std::optional<Eigen::Isometry3d> T_camera_base_start = {};
  double tip_radius = 0;
  /// Largest error of the rough pose; without one, all are searched.
  double start_turn = 20 * std::numbers::pi / 180;
  double start_shift = 30;
};

void visit(TouchPlacementOptions& options, FieldVisitor& visitor);

/// The pose of an arm's base from touches of a surface whose shape is known in the frame of the
/// camera. With each touch, the tip's centre is `tip_radius` off the surface. The pose is searched
/// and judged as by `geometry::register_points`, and fitted by least squares of the distances of
/// the touches that agree with each other. A touch disagrees if its distance is more than five
/// standard deviations, or if the nearest place of the surface is its border.
///
/// The stated deviations come from the distances: an error that all touches share, such as one of
/// the rig or of the tip's radius, is not in them.
/// \param tips 3 x N [mm] the tip's centre in the frame of the base, or the touched point if
/// `tip_radius` is 0.
/// \param surface [mm] frame of the camera; its normals point to where the tip comes from.
/// \throws InvalidInput if a position is not finite, an option is outside its range, or the surface
/// is no valid mesh.
[[nodiscard]] ArmPlacement place_by_touches(const Eigen::Ref<const Eigen::Matrix3Xd>& tips,
                                            const geometry::TriangleMesh& surface,
                                            const TouchPlacementOptions& options = {});

}  // namespace palpate::probing
