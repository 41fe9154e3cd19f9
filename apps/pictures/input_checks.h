// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>

#include "palpate/geometry/range_map.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::pictures {

/// \throws InvalidInput with "`what`: `reason`" unless `holds`.
void refuse_unless(bool holds, const char* what, const std::string& reason);

/// \throws InvalidInput naming `what` if the image is empty or holds no finite value.
void check_image(const geometry::ImageF& image, const char* what);

/// Unlike `geometry::check_mesh` it accepts meshes that a picture can show: with vertices of no
/// triangle that are not finite, or triangles that name a vertex twice.
/// \throws InvalidInput naming `what` unless it has a triangle and each of its triangles joins
/// vertices that exist and are finite.
void check_surface(const geometry::TriangleMesh& mesh, const char* what);

/// \throws InvalidInput naming `what` if it has `got` and not `wanted` entries.
void check_count(Eigen::Index got, Eigen::Index wanted, const char* what);

/// \throws InvalidInput naming `what` unless at least one entry is finite.
void check_some_finite(const Eigen::Ref<const Eigen::MatrixXd>& values, const char* what);

}  // namespace palpate::pictures
