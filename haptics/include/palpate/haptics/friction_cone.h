// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "palpate/probing/acquisition.h"

namespace palpate::haptics {

/// A circular cone with its tip at the origin.
struct Cone {
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();  ///< unit vector, on the side of the vectors
  double slope =
      0;  ///< tangent of the angle between axis and surface; for forces: friction coefficient
  double rms = 0;   ///< of the signed distances from the vectors to the cone, in their unit
  int samples = 0;  ///< vectors that the fit used
};

enum class ConeStop {
  converged,
  /// too few vectors, or too few directions around the axis: axis and slope are not to be used
  not_determined,
  not_converged
};

struct ConeFit {
  Cone cone;
  ConeStop stop = ConeStop::not_determined;  ///< read this before you use the cone
};

/// Fits a circular cone to vectors that lie on it, 3 x N (thesis 5.4.1): least squares of the
/// signed distance cos(angle) |v_T| - sin(angle) v.axis of Eq 5.14, with a Huber loss against
/// outliers. In place of Eq 5.15 the axis moves in the tangent plane of the mean direction.
/// \throws InvalidInput if a vector is not finite, naming its index.
[[nodiscard]] ConeFit fit_cone(const Eigen::Ref<const Eigen::Matrix3Xd>& vectors);

/// Forces on the friction boundary of one contact, 3 x N [N], of the tool on the object.
///
/// The bisection of thesis 4.3 ends between the largest tangential force that held, marked
/// `on_friction_boundary`, and the smallest in the same group and direction that slipped. The
/// boundary is taken in the middle between them; where nothing slipped in that direction, at the
/// force that held.
[[nodiscard]] Eigen::Matrix3Xd boundary_forces(const probing::Contact& contact,
                                               std::span<const probing::Sample> samples);

/// Friction axis of one contact in the space of displacements (thesis 5.4.2), along which a
/// slipping contact follows the tool: unit vector along the mean of the displacements b - c that
/// are marked `on_friction_boundary`; none without such samples. (Not the axis of a fitted cone: on
/// an object that is much stiffer along one tangent than along the other these displacements are
/// far from a cone.)
[[nodiscard]] std::optional<Eigen::Vector3d> friction_axis(
    const probing::Contact& contact, std::span<const probing::Sample> samples);

}  // namespace palpate::haptics
