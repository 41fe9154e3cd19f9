// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "palpate/geometry/eigen_alignment.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/geometry/triangle_mesh.h"
#include "palpate/probing/contact_equilibrium.h"
#include "palpate/probing/finite_element_specimen.h"

namespace palpate::probing {

/// A place of a solid at rest, and the direction from which a tip comes to it.
struct ProbedPlace {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [mm] on the surface
  Eigen::Vector3d inward = Eigen::Vector3d::Zero();    ///< unit length, against the normal
};

/// A solid and the part of its surface that is probed: the part of its boundary at rest that a
/// camera at the origin sees at less than 70 degrees and no support holds. Functions may be called
/// from several threads.
class ProbedSolid {
 public:
  /// \throws InvalidInput, SolverError as `ContactEquilibrium` does, and if the camera sees nothing.
  ProbedSolid(DeformableBody body, const FiniteElementSpecimenOptions& options);

  [[nodiscard]] const ContactEquilibrium& equilibrium() const { return equilibrium_; }
  [[nodiscard]] const geometry::TriangleMesh& surface() const { return surface_; }
  /// The node of the solid that each vertex of the surface is.
  [[nodiscard]] const std::vector<int>& nodes() const { return nodes_; }
  /// The place of the surface that is nearest to `contact` [mm].
  /// \throws InvalidInput unless the contact is finite.
  [[nodiscard]] ProbedPlace place(const Eigen::Vector3d& contact) const;

 private:
  ContactEquilibrium equilibrium_;
  geometry::TriangleMesh surface_;
  std::vector<int> nodes_;
  Eigen::Matrix3Xd normals_;  // of its vertices
  std::optional<geometry::SurfaceQuery> query_;
};

}  // namespace palpate::probing
