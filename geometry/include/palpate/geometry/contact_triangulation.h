// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

enum class ContactTriangulationMethod {
  /// Pinned intrinsic coarsening: an intrinsic Delaunay triangulation of the contacts, whatever the
  /// shape of the surface and however few contacts there are.
  coarsening,
  /// The dual of the geodesic Voronoi cells (thesis 5.3.2.1). Simple, and not always a
  /// triangulation: on thin parts and near the border it leaves contacts out.
  voronoi_dual
};

struct ContactTriangulationOptions {
  ContactTriangulationMethod method = ContactTriangulationMethod::coarsening;
};

/// Weights of contacts at each vertex of a surface. Between them they are linear in each triangle
/// of the surface (see `ContactLocator`).
struct SurfaceWeights {
  Eigen::Matrix3Xi contacts;  ///< 3 x V, the heaviest first; -1 = no (further) contact
  Eigen::Matrix3Xd weights;   ///< 3 x V, >= 0, sum to 1 where there is a contact, else all 0
};

/// Triangles that are known by the lengths of their edges: an intrinsic Delaunay triangulation of
/// contacts and helpers, homeomorphic to the parts of the surface that have contacts (cut open
/// where these touch in a vertex only). Half-edge k of triangle t runs from its corner k to corner
/// (k + 1) % 3; the two angles opposite to an edge sum up to at most pi.
struct IntrinsicDelaunay {
  Eigen::Matrix3Xi triangles;  ///< corners; contacts come first, then helpers
  Eigen::Matrix3Xi opposite;   ///< half-edge 3 t + k on the other side; -1 at the border
  Eigen::Matrix3Xd lengths;    ///< [mm] of each half-edge
  Eigen::Matrix3Xd helpers;    ///< [mm] 3 x H, their places on the surface
};

/// The geodesic Delaunay triangulation of contact points.
struct ContactTriangulation {
  /// Vertices: the contacts, in their order [mm]. Triangles: oriented as the surface; always a
  /// manifold with border (an edge has at most one triangle on each side, a vertex one fan).
  TriangleMesh mesh;
  SurfaceWeights weights;
  /// The contact a vertex of the surface belongs to, V: by `coarsening` the one with the largest
  /// weight, by `voronoi_dual` the nearest; -1 = none (a part without contact).
  Eigen::VectorXi surface_labels;
  /// Contacts that are in no triangle of `mesh`, ascending; empty when all is well.
  std::vector<int> isolated;
  IntrinsicDelaunay intrinsic;  ///< empty by `voronoi_dual`
};

/// `coarsening`: the contacts become vertices of an intrinsic triangulation and are pinned, and so
/// are helpers on the border, about as far apart as contacts are; every other vertex is flattened
/// and removed (Liu, Gillespie, Chislett, Sharp, Jacobson and Crane 2023) and keeps its place in
/// the triangles that remain; one that cannot be flattened stays as a helper. More helpers are
/// added where contacts alone would be joined by two edges, as around a finger. A helper's weights
/// are spread over the contacts harmonically. A vertex of the surface has the weights of its place
/// in its triangle, reduced to three contacts by taking the fourth largest weight off each; one
/// that is a contact has weight one there. On a flat surface with a polygon for a border linear
/// functions are reproduced between contacts. `mesh` has the triangles of contacts after helpers
/// were flipped away as far as the surface's metric allows; on a closed surface without helpers
/// left it has the surface's Euler characteristic. `voronoi_dual`: each place where three cells
/// meet becomes a triangle, unless it is turned over against the surface at its contacts or
/// excluded by one whose cells meet nearer to its contacts; the weights at a vertex of the surface
/// are those of its nearest point on these flat triangles. \throws InvalidInput on a bad mesh,
/// fewer than three contacts, two at one place (within 1e-9 of the surface's diagonal), one not on
/// the surface; `coarsening` on an edge of more than two triangles, or of two turned against each
/// other; `voronoi_dual` when no three cells meet. SolverError from `coarsening`, on numbers that
/// overflow or where helpers do not suffice to tell edges apart: `voronoi_dual` may then do.
[[nodiscard]] ContactTriangulation triangulate_contacts(
    const TriangleMesh& surface, std::span<const SurfacePoint> contacts,
    const ContactTriangulationOptions& options = {});

/// Weights at the vertices of a surface by the nearest point of flat triangles of contacts: for a
/// mesh of contacts that is all that is known.
/// \throws InvalidInput on a bad mesh.
[[nodiscard]] SurfaceWeights project_weights(const TriangleMesh& surface,
                                             const TriangleMesh& contact_mesh);

}  // namespace palpate::geometry
