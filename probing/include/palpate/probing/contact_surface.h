// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "palpate/core/fields.h"
#include "palpate/geometry/triangle_mesh.h"
#include "palpate/probing/acquisition.h"
#include "palpate/probing/contact_misfit.h"

namespace palpate::probing {

/// The meaning, unit and range of each field stand in its list, `visit`.
struct ContactSurfaceOptions {
  double longest_edge = 3;
  double tip_radius = kUsualTipRadius;
};

void visit(ContactSurfaceOptions& options, FieldVisitor& visitor);

struct ContactSurface {
  /// [mm] Vertex k is the contact with index kept[k]; triangles face as the normals do.
  geometry::TriangleMesh mesh;
  std::vector<std::size_t> kept;        ///< ascending
  std::vector<ContactMisfit> left_out;  ///< in the order of the contacts
};

/// Makes a surface of contacts, for an object of which no other is known: the Delaunay
/// triangulation of the contacts in the plane across their mean normal, without triangles that
/// bridge gaps and without needles at the border. Between contacts the surface is flat.
///
/// A contact does not fit if its normal is more than 75 degrees from the mean of all, if most of
/// the area around it, over the radius of the tip, faces away from its normal (`facing_shares`), or
/// if it is too far from the others for any triangle. One in `kContactsPerMisfit` may be so; the
/// surface is made of the others.
/// \throws InvalidInput if there are fewer than three contacts or all are in a line, if two are
/// behind each other, or if more contacts do not fit (as on a surface that is closed or folded).
[[nodiscard]] ContactSurface contact_surface(std::span<const Contact> contacts,
                                             const ContactSurfaceOptions& options = {});

}  // namespace palpate::probing
