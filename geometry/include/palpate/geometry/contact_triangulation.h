// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <span>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

enum class ContactTriangulationMethod {
  /// Pinned intrinsic coarsening: an intrinsic Delaunay triangulation of the contacts, for surfaces
  /// of any shape and any number of contacts.
  delaunay,
  /// Dual of the geodesic Voronoi cells (thesis 5.3.2.1). Simple, but not always a triangulation:
  /// contacts on thin parts and near the border are left out.
  voronoi_dual
};

/// "delaunay" or "voronoi_dual"
[[nodiscard]] const char* to_string(ContactTriangulationMethod method);

struct ContactTriangulationOptions {
  ContactTriangulationMethod method = ContactTriangulationMethod::delaunay;
  /// Called in the calling thread after each part of the work, and by `delaunay` now and then while
  /// vertices are removed; the last call has done == total. If it throws, the work ends.
  std::function<void(int done, int total)> progress = {};
};

/// Weights of contacts at each vertex of a surface. Inside a triangle of the surface they are
/// linear (see `ContactLocator`).
struct SurfaceWeights {
  Eigen::Matrix3Xi contacts;  ///< 3 x V, largest weight first; -1 for no (further) contact
  Eigen::Matrix3Xd weights;   ///< 3 x V, >= 0, sum to 1 where there is a contact, else all 0
};

/// Intrinsic Delaunay triangulation of contacts and helpers, given by edge lengths. It is
/// homeomorphic to the parts of the surface that have contacts (separated where these touch only in
/// a vertex). Half-edge k of triangle t runs from its corner k to corner (k + 1) % 3; the two
/// angles opposite an edge sum to at most pi.
struct IntrinsicDelaunay {
  Eigen::Matrix3Xi triangles;  ///< corners; contacts have the first indices, then helpers
  Eigen::Matrix3Xi opposite;   ///< half-edge 3 t + k on the other side; -1 at the border
  Eigen::Matrix3Xd lengths;    ///< [mm] of each half-edge
  Eigen::Matrix3Xd helpers;    ///< [mm] 3 x H, positions on the surface
};

/// Geodesic Delaunay triangulation of contact points.
struct ContactTriangulation {
  /// Vertices: the contacts, in their order [mm]. Triangles: oriented like the surface; always a
  /// manifold with border (an edge has at most one triangle on each side, a vertex one fan).
  TriangleMesh mesh;
  SurfaceWeights weights;
  /// V: contact to which each vertex of the surface belongs; the one with the largest weight for
  /// `delaunay`, the nearest one for `voronoi_dual`; -1 on a part without contacts.
  Eigen::VectorXi surface_labels;
  /// Contacts in no triangle of `mesh`, ascending. A contact near the border of the surface may be
  /// among helpers only; they still share its weights.
  std::vector<int> isolated;
  IntrinsicDelaunay intrinsic;  ///< empty for `voronoi_dual`
};

/// Triangulates contacts on a surface.
///
/// `delaunay` (Liu, Gillespie, Chislett, Sharp, Jacobson and Crane 2023): the contacts become
/// pinned vertices of an intrinsic triangulation, together with helpers on the border about as far
/// apart as contacts. Every other vertex is flattened and removed, and keeps its place in the
/// remaining triangles; a vertex that cannot be flattened stays as a helper. Further helpers are
/// added where two edges would join the same contacts, as around a finger.
/// - Weights: those of a helper are distributed harmonically over the contacts. A vertex of the
///   surface has the weights of its place, reduced to three contacts by subtracting the fourth
///   largest weight from each; a vertex that is a contact has weight one there. On a flat surface
///   with a polygonal border linear functions between contacts are reproduced.
/// - `mesh` has the triangles of contacts after edges at helpers were flipped as far as the metric
///   allows. On a closed surface without remaining helpers it has the surface's Euler
///   characteristic.
///
/// `voronoi_dual`: each place where three cells meet becomes a triangle, unless it is flipped
/// relative to the surface at its contacts or conflicts with one whose cells meet closer to its
/// contacts. The weights of a vertex are those of its nearest point on these flat triangles.
/// \throws InvalidInput if the mesh is not valid; there are fewer than three contacts; two contacts
/// coincide (within 1e-9 of the surface's diagonal); or one is not on the surface. Also, for
/// `delaunay`, if an edge has more than two triangles or two of opposite orientation; for
/// `voronoi_dual`, if no three cells meet.
/// \throws SolverError from `delaunay` if numbers overflow or helpers do not suffice to make the
/// edges distinct; `voronoi_dual` may then succeed.
[[nodiscard]] ContactTriangulation triangulate_contacts(
    const TriangleMesh& surface, std::span<const SurfacePoint> contacts,
    const ContactTriangulationOptions& options = {});

/// Computes weights at the vertices of a surface from the nearest points of flat triangles of
/// contacts. Use it if nothing but the mesh of contacts is known.
/// \throws InvalidInput if a mesh is not valid.
[[nodiscard]] SurfaceWeights project_weights(const TriangleMesh& surface,
                                             const TriangleMesh& contact_mesh);

}  // namespace palpate::geometry
