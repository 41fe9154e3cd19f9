// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "palpate/geometry/attribute.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// Positions of the corners of triangles in a texture. A vertex may have several of them: at the
/// seams, where the charts meet into which the surface was cut.
struct CornerTexture {
  /// 6 x T: u and v of the first, second and third corner of each triangle; all NaN for a triangle
  /// without a texture.
  Eigen::Matrix<double, 6, Eigen::Dynamic> coordinates;
  /// T, number of each triangle's texture: an index to `MeshFile::materials` for OBJ, and to the
  /// "TextureFile" comments for PLY; -1 for none. Empty if there are no numbers.
  Eigen::VectorXi number;
};

/// The texture among the attributes of triangles, named as in PLY files: `texcoord`, lists of six
/// numbers (of none for a triangle without a texture), and `texnumber`. Nullopt if there is
/// neither; a list of any other size counts as none.
[[nodiscard]] std::optional<CornerTexture> corner_texture(const Attributes& triangle_attributes);

/// Adds or replaces `texcoord` (as float if all coordinates are, else as double) and `texnumber`,
/// as far as there are any.
void set_corner_texture(Attributes& triangle_attributes, const CornerTexture& texture);

/// The texture of a mesh made by `repair_mesh` or `fill_holes` of another one: a triangle with the
/// corners of a former one, in any order, has its texture. Others, such as those of a patch, have
/// none.
/// \param source of each vertex: the former vertex, or -1.
/// \throws InvalidInput unless the texture has as many triangles as `before`, and `source` as many
/// vertices as `after`.
[[nodiscard]] CornerTexture carried_texture(const CornerTexture& texture,
                                            const TriangleMesh& before, const TriangleMesh& after,
                                            std::span<const int> source);

}  // namespace palpate::geometry
