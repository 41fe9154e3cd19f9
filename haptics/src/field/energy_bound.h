// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "field/rounded_number.h"
#include "palpate/haptics/force_field.h"

namespace palpate::haptics {

/// A cube of displacements.
struct Cell {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< [mm]
  double half_width = 0;                             ///< [mm]
};

/// Rigorous bounds of q(x) = p(x) - margin / 2 |x|^2 for the energy p of a field. If q >= 0, the
/// energy is >= 0 for this field and for all fields whose stiffness between zero and x differs by
/// less than the margin.
class EnergyBound {
 public:
  /// For places within `radius` [mm] of zero. `margin` covers the change of stiffness of fields
  /// that differ by CertificateOptions::number_tolerance.
  EnergyBound(const ForceField& field, double radius, double number_tolerance);

  /// [N/mm]
  [[nodiscard]] double margin() const { return margin_; }

  struct InCell {
    RoundedNumber at_center;  ///< [N mm] q at the centre of the cell
    double lowest = 0;        ///< [N mm] q >= this in all of the cell
  };
  [[nodiscard]] InCell in_cell(const Cell& cell) const;

  /// [N mm] p at a place.
  [[nodiscard]] RoundedNumber energy(const Eigen::Vector3d& place) const;

  /// [mm] Distance from zero up to which q >= 0; at most `radius`, 0 if nothing is certain.
  [[nodiscard]] double safe_radius() const;

 private:
  using Vector = std::array<RoundedNumber, 3>;

  // Values that do not depend on the place. For a ridge, P = r r^T, |P d| = |n.d| with n = |r| r.
  struct Base {
    bool ridge = false;
    double weight = 0;
    RoundedNumber epsilon_squared;
    Vector center;          // g, isotropic
    Vector normal;          // n, ridge
    RoundedNumber offset;   // n.g, ridge
    RoundedNumber at_zero;  // s(0)
    Vector slope_at_zero;   // grad s(0)
    double steepest = 1;    // >= |P h|, |P h|^2 and |P h|^3 for every unit vector h
  };

  struct Root;

  struct Taylor {
    RoundedNumber value;                   // q
    Vector gradient;                       // of q
    std::array<RoundedNumber, 6> hessian;  // of q: xx, xy, yy, xz, yz, zz
    double third = 0;    // >= |third derivative along a unit vector| within the reach
    double concave = 0;  // >= minus the smallest eigenvalue of the Hessian within the reach
  };

  // Taylor expansion about a place, with bounds that hold within `reach` of it.
  [[nodiscard]] Taylor expand(const Eigen::Vector3d& place, double reach) const;

  std::vector<Base> bases_;
  double radius_, margin_;
};

}  // namespace palpate::haptics
