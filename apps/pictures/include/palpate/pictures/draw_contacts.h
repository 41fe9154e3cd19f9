// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::pictures {

/// Draws a surface with its contacts as a PNG of 1200 x 900 px, seen as by `draw_mesh`: the cells
/// of the contacts in soft colours (neighbours differ, no cell is light grey), the edges of the
/// triangulation above the surface, each contact with its number. `labels`: the contact that counts
/// most at each vertex of the surface, -1 = none. `contact_mesh`: the contacts as vertices, and
/// their triangles (there may be none). Works without a display. \throws InvalidInput if a mesh is
/// not valid, or labels do not fit the surface or the contacts; OutputError.
void draw_contacts(const std::filesystem::path& png, const geometry::TriangleMesh& surface,
                   const Eigen::Ref<const Eigen::VectorXi>& labels,
                   const geometry::TriangleMesh& contact_mesh, const std::string& title);

}  // namespace palpate::pictures
