// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "palpate/geometry/triangle_mesh.h"
#include "palpate/probing/acquisition.h"

namespace palpate::probing {

struct ContactSurfaceOptions {
  /// A triangle is left out if an edge is longer than this times the median edge; > 1 and finite.
  double longest_edge = 3;
};

/// Makes a surface of contacts, for an object of which no other is known: the Delaunay
/// triangulation of the contacts in the plane across their mean normal, without triangles that
/// bridge gaps and without needles at the border. Vertex k is contact k [mm]; triangles face as the
/// normals do. Between contacts the surface is flat.
/// \throws InvalidInput if there are fewer than three contacts or all are in a line; if the normals
/// of a contact and of all contacts differ by more than 75 degrees, or a triangle faces away from
/// the normal of one of its contacts (a surface that is closed or folded); or if a contact is too
/// far from the others for any triangle.
[[nodiscard]] geometry::TriangleMesh contact_surface(std::span<const Contact> contacts,
                                                     const ContactSurfaceOptions& options = {});

}  // namespace palpate::probing
