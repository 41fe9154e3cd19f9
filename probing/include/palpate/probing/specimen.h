// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "palpate/geometry/eigen_alignment.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::probing {

/// The tool holds if its force lies in this cone: with f_a the part of the force along `axis`,
/// |f - f_a axis| <= coefficient f_a.
struct FrictionCone {
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();  ///< into the object, unit length, world frame
  double coefficient = 0;                          ///< >= 0
};

/// Retarded elasticity of a standard linear solid: a tool under the force f(t) is displaced by
/// (1 - share) d(f) + r with time dr/dt = share d(f) - r, where d(f) is the equilibrium. In a cycle
/// of forces such an object takes energy, never gives any.
struct Retardation {
  double share = 0;  ///< of the displacement; 0 is elastic; in [0, 1)
  double time = 1;   ///< [s] > 0
};

/// Displacements at one contact of a specimen, asked from one thread at a time.
class SpecimenContact {
 public:
  virtual ~SpecimenContact() = default;
  /// [mm] As `Specimen::displacement`.
  [[nodiscard]] virtual Eigen::Vector3d displacement(const Eigen::Vector3d& force) = 0;
};

/// A deformable object whose truth is known, in quasi-static equilibrium with the tip of a tool.
/// All vectors are in the world frame. A contact is a place on the undeformed surface; the nearest
/// place is taken if it lies beside the surface. Functions may be called from several threads.
class Specimen {
 public:
  virtual ~Specimen() = default;

  /// The undeformed surface, its triangles turned outwards.
  [[nodiscard]] virtual const geometry::TriangleMesh& surface() const = 0;

  /// [mm] Displacement of the tool from `contact` when it applies `force` [N] to the object
  /// without slipping: the equilibrium that is reached by increasing the force from zero.
  /// \throws SolverError if there is none, InvalidInput unless contact and force are finite.
  [[nodiscard]] virtual Eigen::Vector3d displacement(const Eigen::Vector3d& contact,
                                                     const Eigen::Vector3d& force) const = 0;

  /// Returns true if `deformed_surface` is known. Most closed forms know the displacement of the
  /// tool alone.
  [[nodiscard]] virtual bool knows_shape() const { return false; }
  /// [mm] 3 x V: positions of the vertices of `surface` in the equilibrium of `displacement`.
  /// \throws InvalidInput if the shape is not known, and as `displacement`.
  [[nodiscard]] virtual Eigen::Matrix3Xd deformed_surface(const Eigen::Vector3d& contact,
                                                          const Eigen::Vector3d& force) const;

  /// For many forces at one contact, while the specimen exists. May be faster than `displacement`;
  /// results are the same to the tolerance of a solver, and may depend on the forces before.
  [[nodiscard]] virtual std::unique_ptr<SpecimenContact> at(const Eigen::Vector3d& contact) const;

  /// \throws InvalidInput unless the contact is finite.
  [[nodiscard]] virtual FrictionCone friction_cone(const Eigen::Vector3d& contact) const = 0;

  /// [mm] of the ball that touches it; none if the tip is not a ball, or a point.
  [[nodiscard]] virtual std::optional<double> tip_radius() const { return std::nullopt; }

  /// The approach to its equilibria: at once, unless it says otherwise.
  [[nodiscard]] virtual Retardation retardation() const { return {}; }
};

}  // namespace palpate::probing
