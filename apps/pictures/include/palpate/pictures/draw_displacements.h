// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::pictures {

/// Draws how far each contact gives way, as Figure 4.10 of the thesis: a surface in the view of
/// `draw_mesh`, and at each contact a circle whose diameter is proportional to a displacement. A
/// second bar shows the diameter of a given displacement. PNG of 1200 x 900 px. Works
/// without a display.
/// \param contacts [mm] 3 x N.
/// \param displacements [mm] N, along the normal into the object; contacts with one that is not
/// finite, or below zero, are drawn as points.
/// \throws InvalidInput if the surface is not valid, a contact is not finite, a size differs, or no
/// displacement is above zero.
/// \throws OutputError if the picture cannot be written.
void draw_displacements(const std::filesystem::path& png, const geometry::TriangleMesh& surface,
                        const Eigen::Ref<const Eigen::Matrix3Xd>& contacts,
                        const Eigen::Ref<const Eigen::VectorXd>& displacements,
                        const std::string& title);

}  // namespace palpate::pictures
