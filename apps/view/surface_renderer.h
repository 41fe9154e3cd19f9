// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "camera.h"
#include "gl.h"
#include "surface_shape.h"

namespace palpate::view {

/// Colours of vertices: 4 x V bytes, red, green, blue, 255.
using VertexColors = Eigen::Matrix<unsigned char, 4, Eigen::Dynamic>;

struct SurfaceLook {
  bool wireframe = false;  ///< edges too
  bool lit = true;         ///< shaded; otherwise the colours as they are, to read values from
  /// A dense surface with a third of its triangles, of the same vertices: for a picture that the
  /// next one replaces at once.
  bool coarse = false;
};

/// Draws one surface in one call of the graphics system. Constant data stay in its memory.
class SurfaceRenderer {
 public:
  SurfaceRenderer();

  void put(const SurfaceShape& shape);
  void put_colors(const VertexColors& colors);
  /// Vertices that moved.
  void update(const SurfaceShape& shape, const VertexRange& range);
  void update_colors(const VertexColors& colors, const VertexRange& range);
  void draw(const Shot& shot, const SurfaceLook& look) const;

 private:
  ShaderProgram dense_, coarse_;
  VertexArray array_;
  GLsizei corners_ = 0, coarse_corners_ = 0;
  bool is_dense_ = false;
};

}  // namespace palpate::view
