// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/probing/acquisition.h"

namespace palpate::haptics {

/// A sheet stretched between two parallel supports. A contact feels only the strip it lies on: two
/// elastic segments that meet at the tool (thesis 4.2 and 5.3.3: latex over a gap).
///
/// With x = axis.(c - origin) and q = across.(c - origin) for the contact c, the segments have the
/// lengths L_1 = x - low_support and L_2 = high_support - x. The sheet moves by e at the tool; the
/// skin under the tool yields in series, so the tool moves by d = e + compliance f. In the
/// contact's frame (X: axis projected onto the tangent plane, Z: into the object, Y = Z x X) the
/// sheet's energy is
///   U(e) = w sum_i (tension (l_i - L_i) + axial_stiffness / (2 L_i) (l_i - L_i)^2)
///          + lateral_stiffness / 2 e_y^2,
///   l_1 = |(L_1 + e_x, e_y, e_z)|, l_2 = |(e_x - L_2, e_y, e_z)|, w = 1 + slope q + curvature q^2,
/// and that of the object is V(d) = min_e U(e) + |d - e|^2 / (2 compliance); f = dV/dd.
struct StripModel {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();   ///< [mm]
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();    ///< unit vector from support to support
  Eigen::Vector3d across = Eigen::Vector3d::UnitY();  ///< unit vector, orthogonal to `axis`
  double low_support = 0;        ///< [mm] along `axis` from `origin`; below all contacts
  double high_support = 0;       ///< [mm] above all contacts
  double tension = 0;            ///< [N] of the undeformed strip at `origin`; >= 0
  double axial_stiffness = 0;    ///< [N] force per strain of a segment at `origin`; >= 0
  double lateral_stiffness = 0;  ///< [N/mm] against motion across the strip; >= 0
  double compliance = 0;         ///< [mm/N] of the skin under the tool; >= 0
  double slope = 0;              ///< [1/mm] variation of tension and stiffness across the sheet
  double curvature = 0;          ///< [1/mm^2] second-order term of this variation
};

// Displacements are tool minus contact; forces act ON THE OBJECT; world frame. All functions throw
// InvalidInput unless the contact is between the supports, its strip has a width > 0, the axis is
// not parallel to its normal, and the numbers are finite and in their ranges; SolverError if there
// is no equilibrium nearby.

/// [N mm] Elastic energy V(d).
[[nodiscard]] double potential(const StripModel& model, const probing::Contact& contact,
                               const Eigen::Vector3d& displacement);
/// [N] Gradient of the energy.
[[nodiscard]] Eigen::Vector3d force(const StripModel& model, const probing::Contact& contact,
                                    const Eigen::Vector3d& displacement);
/// [N/mm] Hessian of the energy, (H^-1 + compliance I)^-1 with the Hessian H of U.
[[nodiscard]] Eigen::Matrix3d stiffness(const StripModel& model, const probing::Contact& contact,
                                        const Eigen::Vector3d& displacement);
/// [mm] Displacement of the tool under a force: the inverse of `force`.
[[nodiscard]] Eigen::Vector3d displacement(const StripModel& model, const probing::Contact& contact,
                                           const Eigen::Vector3d& force);

}  // namespace palpate::haptics
