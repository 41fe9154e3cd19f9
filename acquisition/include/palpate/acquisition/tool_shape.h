// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/geometry/eigen_alignment.h"
#include "palpate/geometry/range_map_score.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::acquisition {

/// The end of an arm as a camera sees it: a ball at the end of a straight shaft of the same radius.
/// What holds the shaft is not part of it.
struct ToolShape {
  double radius = 3;  ///< [mm] > 0
  double shaft = 40;  ///< [mm] length behind the centre of the ball; > 0
};

/// Where a tool is, in any frame.
struct ToolPose {
  /// [mm] The foremost point of the ball, which is the position of a tip.
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();
  /// Unit length: the way it came, against the shaft.
  Eigen::Vector3d inward = Eigen::Vector3d::UnitZ();
};

/// A closed surface, its triangles turned outwards.
/// \throws InvalidInput if a length is outside its range.
[[nodiscard]] geometry::TriangleMesh tool_mesh(const ToolShape& shape, const ToolPose& pose);

/// The pixels whose rays pass within `margin` of the tool: what lies behind it is not seen there,
/// and what is seen is the tool.
/// \param rays of the pixels, as `geometry::pixel_rays` gives them; the rows x columns of the
/// result.
/// \param pose in the frame of the camera. \param margin [mm] >= 0
/// \throws InvalidInput if a length is outside its range.
[[nodiscard]] geometry::PixelMask hidden_by_tool(const Eigen::Matrix2Xd& rays, Eigen::Index rows,
                                                 const ToolShape& shape, const ToolPose& pose,
                                                 double margin);

}  // namespace palpate::acquisition
