// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "palpate/probing/contact_equilibrium.h"

// The laws of contact at one point of the surface.
namespace palpate::probing {

// A rigid ball that pushes with `normal_stiffness` times the depth. Tangentially a point keeps to
// the direction of its anchor, as seen from the centre: the potential is tangential_stiffness R^2
// (1 - n.a) with n the direction of the point and a that of its anchor, unit vectors, so that
// sticking conserves energy. With friction, the tangential traction is returned to the cone.
// Without slip, the potential rises from zero over `stick_depth`, so that points that leave lose
// nothing.
struct TipLaw {
  double radius = 0;                // [mm]
  double friction = 0;              // coefficient; infinity: sticking
  double normal_stiffness = 0;      // [N/mm^3]
  double tangential_stiffness = 0;  // [N/mm^3]
};

struct TipTraction {
  Eigen::Vector3d traction = Eigen::Vector3d::Zero();  // [N/mm^2] on the object
  Eigen::Matrix3d tangent = Eigen::Matrix3d::Zero();   // its derivative by the point's position
  Eigen::Vector3d anchor = Eigen::Vector3d::Zero();    // from which the next load step starts
  double energy = 0;  // [N/mm] of the springs, if the point sticks to a given anchor
  bool slips = false;
};

// `point` and `start` are relative to the centre of the tip, now and at the start of the load step.
// A point without an anchor takes the place where the straight way between them enters the ball, or
// `start` if that is inside. Nothing if the point is outside the ball.
[[nodiscard]] std::optional<TipTraction> tip_traction(const TipLaw& law,
                                                      const Eigen::Vector3d& point,
                                                      const Eigen::Vector3d& start,
                                                      const std::optional<Eigen::Vector3d>& anchor);

struct ObstacleTraction {
  Eigen::Vector3d traction;
  Eigen::Matrix3d tangent;
};
// Without friction; nothing if the point is outside the block.
[[nodiscard]] std::optional<ObstacleTraction> obstacle_traction(const RigidBlock& block,
                                                                double stiffness,
                                                                const Eigen::Vector3d& point);

}  // namespace palpate::probing
