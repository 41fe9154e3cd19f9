// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "contacts/contact_weights.h"
#include "contacts/intrinsic_triangulation.h"
#include "palpate/core/work_steps.h"
#include "palpate/geometry/contact_triangulation.h"

namespace palpate::geometry {

/// Result of both methods: triangles of contacts that may still touch in single vertices.
struct TrianglesOfContacts {
  std::vector<std::array<int, 3>> triangles;
  SurfaceWeights weights;          ///< if empty, to be projected onto the triangles
  Eigen::VectorXi surface_labels;  ///< see ContactTriangulation
  IntrinsicDelaunay intrinsic;
};

/// A surface coarsened to its contacts and the helpers on its border: pinned intrinsic coarsening.
class CoarsenedSurface {
 public:
  /// \param places positions of the contacts [mm].
  /// \param steps counts the vertices removed.
  /// Precondition: valid input; `mesh` outlives this.
  CoarsenedSurface(const TriangleMesh& mesh, std::span<const SurfacePoint> contacts,
                   Eigen::Matrix3Xd places, WorkSteps& steps);

  /// Removes a contact; those after it move up. At the border, whose shape needs it, and where it
  /// cannot be flattened, it stays as a helper. False, without a change, if no other contact is on
  /// its part of the surface.
  [[nodiscard]] bool leave_out(int contact);

  /// The triangles and weights, once. Adds the helpers that make the edges distinct.
  [[nodiscard]] TrianglesOfContacts triangles();

  /// [mm] of the contacts
  [[nodiscard]] const Eigen::Matrix3Xd& places() const { return places_; }

 private:
  void keep_parts_with(std::span<const SurfacePoint> contacts);
  void list_new_ids();
  void insert(std::span<const SurfacePoint> contacts);
  void pin_helpers();
  [[nodiscard]] IntrinsicDelaunay intrinsic() const;
  void add_row(int id, double factor, WeightRow& row) const;
  [[nodiscard]] SurfaceWeights weights() const;

  const TriangleMesh& mesh_;
  Eigen::Matrix3Xd places_;  ///< [mm] of the contacts
  IntrinsicTriangulation surface_;
  std::vector<int> slot_;  ///< slot of each triangle of the mesh; kNone if left out
  int fans_end_ = 0;       ///< lower ids are vertices of the mesh and their additional fans
  std::vector<Eigen::Vector3d> positions_;  ///< [mm] by id
  std::vector<int> contact_of_id_;          ///< -1 = none
  std::vector<char> pinned_;
  std::vector<WeightRow> rows_;  ///< by id, of vertices
};

/// The first step of both methods: the positions of the contacts, 3 x k [mm].
/// \throws InvalidInput as `triangulate_contacts`.
[[nodiscard]] Eigen::Matrix3Xd places_of_contacts(const TriangleMesh& surface,
                                                  std::span<const SurfacePoint> contacts);

/// The last step of both methods: keeps only one fan of triangles at each contact, and lists the
/// contacts without any. `places`: positions of the contacts [mm].
[[nodiscard]] ContactTriangulation with_manifold_vertices(TrianglesOfContacts found,
                                                          Eigen::Matrix3Xd places);

/// Dual of geodesic Voronoi cells, with edges already manifold. Precondition: valid input.
[[nodiscard]] TrianglesOfContacts voronoi_dual(const TriangleMesh& surface,
                                               std::span<const SurfacePoint> contacts,
                                               const Eigen::Matrix3Xd& places);

}  // namespace palpate::geometry
