// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "finite_elements/quadratic_tetrahedron.h"
#include "finite_elements/tip_contact.h"
#include "palpate/probing/contact_equilibrium.h"

// Forces on the nodes of a solid and on the tip, and their derivatives.
namespace palpate::probing {

// The integration points that faces of one fineness share.
struct FaceRule {
  Eigen::Matrix<double, 6, Eigen::Dynamic> shapes;  // a column is a point
  std::vector<Eigen::Matrix<double, 6, 2>> gradients;
  double weight = 0;  // of each point, of the area
};

struct ContactFace {
  BoundaryFace face;
  std::shared_ptr<const FaceRule> rule;
  Eigen::VectorXd weights;  // [mm^2] of the undeformed surface, at the points
  int first_point = 0;      // number of its first point among those of all faces
  double stiffness = 0;     // [N/mm^3] of contact
  double reach = 0;         // [mm] largest distance of two of its nodes
};

// The effect of the tip on a face: derivatives of the traction at its points.
struct FaceContact {
  int face = 0;
  int point = 0;
  Eigen::Matrix3d tangent;  // [N/mm], weighted
};

struct SystemForces {
  Eigen::VectorXd nodes;  // 3 N [N] unbalanced: inner forces minus those of tip and obstacles
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();  // [N] on the object
  bool valid = false;                             // no element is inverted
  std::vector<FaceContact> contacts;
  std::vector<ContactAnchor> anchors;
  int slipping = 0;
  double reaction = 0;  // [N] norm of the forces of supports
};

class ContactSystem {
 public:
  ContactSystem(const DeformableBody& body, const EquilibriumOptions& options);

  // Forces at given positions, on the way from a state. Without a tip if `start` is null.
  [[nodiscard]] SystemForces forces(const Eigen::Matrix3Xd& positions, const Eigen::Vector3d& tip,
                                    const ContactState* start) const;
  // The tangent of an element, with what obstacles do to its faces.
  [[nodiscard]] ElementMatrix tangent(const Eigen::Matrix3Xd& positions, int element) const;
  [[nodiscard]] double elastic_energy(const Eigen::Matrix3Xd& positions) const;

  [[nodiscard]] const std::vector<ContactFace>& faces() const { return faces_; }
  [[nodiscard]] const Eigen::Matrix<int, 10, Eigen::Dynamic>& elements() const {
    return body_.mesh.elements;
  }
  [[nodiscard]] const std::vector<bool>& fixed() const { return fixed_; }

 private:
  void add_tip(const Eigen::Matrix3Xd& positions, const Eigen::Vector3d& tip,
               const ContactState& start, SystemForces& result) const;
  void add_obstacles(const Eigen::Matrix3Xd& positions, SystemForces& result) const;

  const DeformableBody& body_;
  EquilibriumOptions options_;
  std::vector<TetrahedronPoints> points_;
  std::vector<PackedPoints> packed_points_;  // the same
  std::vector<ContactFace> faces_;
  std::vector<std::vector<int>> faces_of_element_;
  std::vector<bool> fixed_;
};

}  // namespace palpate::probing
