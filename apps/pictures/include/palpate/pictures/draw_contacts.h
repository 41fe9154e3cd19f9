// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::pictures {

/// Draws a surface with its contacts as a PNG of 1200 x 900 px in the view of `draw_mesh`: the
/// cells of the contacts in soft colours (neighbours differ, no cell is light grey), the edges of
/// the triangulation above the surface, and each contact with its id. Works without a display.
/// \param labels contact with the largest weight at each vertex of the surface, -1 if none.
/// \param contact_mesh the contacts as vertices, and their triangles (there may be none).
/// \param ids of the contacts.
/// \throws InvalidInput if a mesh is not valid, or labels or ids do not fit the surface or the
/// contacts.
/// \throws OutputError if the picture cannot be written.
void draw_contacts(const std::filesystem::path& png, const geometry::TriangleMesh& surface,
                   const Eigen::Ref<const Eigen::VectorXi>& labels,
                   const geometry::TriangleMesh& contact_mesh, const std::vector<long long>& ids,
                   const std::string& title);

}  // namespace palpate::pictures
