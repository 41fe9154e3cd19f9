// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "palpate/geometry/eigen_alignment.h"
#include "palpate/probing/finite_element_mesh.h"
#include "palpate/probing/hyperelastic.h"

namespace palpate::probing {

/// A rigid block without friction; a large one is a plane. Points inside its rounded box are pushed
/// out.
struct RigidBlock {
  Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = Eigen::Vector3d::Zero();  ///< [mm] corners
  double rounding = 1;  ///< [mm] of edges; above 0, at most half of the shortest side
};

/// A solid in large deformation. All in one frame.
struct DeformableBody {
  FiniteElementMesh mesh;               ///< undeformed and without stress
  std::vector<Hyperelastic> materials;  ///< of region 0, 1, ...
  std::vector<int> supported;           ///< nodes that are held
  Eigen::Matrix3Xd support_moves;       ///< 3 x supported [mm]: pre-stretch; empty: none
  std::vector<RigidBlock> obstacles;
};

/// The same solid with each tetrahedron divided into eight. Boundaries keep their shape.
[[nodiscard]] DeformableBody refined(const DeformableBody& body);

struct EquilibriumOptions {
  double tip_radius = 5;  ///< [mm] of the rigid ball; > 0
  /// Coefficient of friction between ball and surface; >= 0. Infinity: points stick where they
  /// touch.
  double friction = std::numeric_limits<double>::infinity();
  /// Stiffness of the contact per area, times the length of a face over the Young's modulus below
  /// it; > 0. Larger is more exact, and harder to solve.
  double stiffness = 50;
  double tolerance = 1e-6;  ///< converged if unbalanced forces <= tolerance times |force|; > 0
  int load_steps = 1;       ///< least number of steps to apply a force or motion; >= 1
  int max_iterations = 30;  ///< of Newton's method in a load step, before it is halved; >= 1
  int max_halvings = 5;     ///< of a load step, before it is given up; >= 0
  bool exact_tangent =
      false;  ///< factor the whole matrix in each iteration: slower, for comparison
};

/// The direction from the tip's centre at which a point of the surface sticks.
struct ContactAnchor {
  int point = 0;
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
};

/// An equilibrium, from which the next one can start.
struct ContactState {
  Eigen::Matrix3Xd positions;                       ///< 3 x N [mm] of the nodes
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();    ///< [mm] centre of the ball
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N] on the object
  std::vector<ContactAnchor> anchors;               ///< of the points in contact
  int place = 0;  ///< boundary node beside which the tip first touched
  Eigen::Vector3d inward = Eigen::Vector3d::Zero();  ///< unit length: direction of the approach
};

enum class ContactStop {
  converged,
  tip_slides,         ///< each point in contact slips: friction cannot hold the force
  contact_lost,       ///< the tip left the object
  elements_inverted,  ///< the mesh cannot follow the deformation
  not_converged,      ///< no equilibrium found in the allowed iterations
};
[[nodiscard]] const char* to_string(ContactStop stop);

struct ContactResult {
  ContactState state;  ///< the equilibrium, or the last one on the way to it
  ContactStop stop = ContactStop::not_converged;  ///< read this before you use the state
  int load_steps = 0;
  int iterations = 0;
  int factorisations = 0;  ///< of the whole matrix
  int points = 0;          ///< integration points in contact
  int slipping = 0;        ///< of these
};

class ContactEquilibrium;

/// Two solids on the same nodes that differ in one parameter, such as a modulus, on both sides of a
/// third one; and where the tip touches each before it presses.
struct SolidChange {
  const ContactEquilibrium* less = nullptr;
  const ContactEquilibrium* more = nullptr;
  ContactState from_less, from_more;
  double step = 0;  ///< of the parameter between the two; > 0
};

/// Derivatives of the tip's motion by the force and by parameters of the solid.
struct TipSensitivity {
  Eigen::Matrix3d compliance;   ///< [mm/N] derivative of its displacement by the force
  Eigen::Matrix3Xd by_changes;  ///< 3 x changes [mm] derivatives by the parameters
};

/// Equilibria of a solid with a rigid ball that presses and drags on it. Functions may be called
/// from several threads; their results depend on their arguments only.
class ContactEquilibrium {
 public:
  /// Finds the equilibrium without the tip, after supports have moved.
  /// \throws InvalidInput if a number is outside its range, the mesh is not valid (see
  /// `check_finite_element_mesh`), a region has no material or a part of the solid no support.
  /// \throws SolverError if there is no equilibrium.
  explicit ContactEquilibrium(DeformableBody body, const EquilibriumOptions& options = {});
  ~ContactEquilibrium();
  ContactEquilibrium(ContactEquilibrium&&) noexcept;
  ContactEquilibrium& operator=(ContactEquilibrium&&) noexcept;

  [[nodiscard]] const DeformableBody& body() const;
  /// 3 x N [mm] of the nodes, at rest without the tip.
  [[nodiscard]] const Eigen::Matrix3Xd& rest() const;
  [[nodiscard]] const std::vector<BoundaryFace>& faces() const;

  /// The ball just touching the object at rest when it comes along `inward` (unit length) to
  /// `place` [mm]. It may touch beside it.
  /// \throws InvalidInput if the ball would be inside the object or an obstacle before it arrives.
  [[nodiscard]] ContactState touch(const Eigen::Vector3d& place,
                                   const Eigen::Vector3d& inward) const;

  /// Changes the force on the object [N] along a straight line; the tip moves freely.
  [[nodiscard]] ContactResult apply_force(const ContactState& from,
                                          const Eigen::Vector3d& force) const;
  /// Moves the tip's centre [mm] along a straight line.
  [[nodiscard]] ContactResult move_tip(const ContactState& from, const Eigen::Vector3d& tip) const;

  /// Ascending: the nodes of faces that the tip touches in an equilibrium of this solid.
  [[nodiscard]] std::vector<int> touched_nodes(const ContactState& state) const;

  /// [N mm] Elastic energy of the solid.
  [[nodiscard]] double elastic_energy(const Eigen::Matrix3Xd& positions) const;

 private:
  friend class ContactSeries;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Equilibria under several forces at one place. Each is that of `ContactEquilibrium::apply_force`
/// from the state `from`, to the tolerance of the solver, but takes a fraction of the time since it
/// is sought from the nearest one found before. Last digits thus depend on the order of the forces.
/// Ask from one thread at a time, while the solid exists.
class ContactSeries {
 public:
  ContactSeries(const ContactEquilibrium& solid, ContactState from);
  ~ContactSeries();
  ContactSeries(ContactSeries&&) noexcept;
  ContactSeries& operator=(ContactSeries&&) noexcept;

  [[nodiscard]] const ContactState& from() const;
  /// Changes the force on the object [N] along the straight line from that of `from()`.
  [[nodiscard]] ContactResult apply_force(const Eigen::Vector3d& force);

  /// Derivatives of the motion of the tip between `from()` and the equilibrium `at`, which
  /// `apply_force` has found, to about a hundredth; less exact if it took several load steps.
  /// \throws InvalidInput if a changed solid has other nodes.
  /// \throws SolverError if the equilibrium is not stable, or a changed solid has inverted elements.
  [[nodiscard]] TipSensitivity sensitivity(const ContactState& at,
                                           std::span<const SolidChange> changes);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::probing
