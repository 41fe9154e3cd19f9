// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "camera.h"
#include "gl.h"
#include "shapes.h"

namespace palpate::view {

/// A solid in the scene.
struct Solid {
  Shape shape = Shape::ball;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< [mm]
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();   ///< unit: where the shape's +z points
  Eigen::Vector3d size = Eigen::Vector3d::Ones();    ///< [mm] of the shape's unit along x, y, z
  Eigen::Vector3f color = Eigen::Vector3f::Zero();
  float opacity = 1;
};

/// An arrow from `origin` along `way` [mm], of solids; none if it is shorter than its tip is worth.
/// \param diagonal [mm] of the object, to which its thickness is relative.
[[nodiscard]] std::vector<Solid> arrow(const Eigen::Vector3d& origin, const Eigen::Vector3d& way,
                                       double diagonal, const Eigen::Vector3f& color);

/// Many points, or lines from each even column to the next one, with a colour each.
struct ColoredPoints {
  Eigen::Matrix3Xf positions;                              ///< [mm] 3 x N
  Eigen::Matrix<unsigned char, 4, Eigen::Dynamic> colors;  ///< 4 x N: red, green, blue, opacity
};

/// Points or lines in the memory of the graphics system.
class PointSet {
 public:
  void put(const ColoredPoints& points);
  [[nodiscard]] GLsizei count() const { return count_; }
  void bind() const { array_.bind(); }

 private:
  VertexArray array_;
  GLsizei count_ = 0;
};

/// Draws what is not a surface: backdrop, solids, points and lines.
class SceneRenderer {
 public:
  SceneRenderer();

  /// Forgets all depths of the last picture.
  static void begin();
  /// Fills the viewport where no surface was drawn; after the surfaces, because without graphics
  /// hardware a pixel that is drawn twice costs twice. Before anything transparent.
  void draw_backdrop() const;
  /// Parts behind surfaces show through faintly: a force is never out of sight in a dent.
  void draw(const std::vector<Solid>& solids, const Shot& shot) const;
  /// \param size [px]. \param lift [mm] towards the eye, so that a slanted surface does not cut them
  void draw_points(const PointSet& points, const Shot& shot, float size, double lift) const;
  void draw_lines(const PointSet& lines, const Shot& shot) const;

 private:
  void draw_all(const std::vector<Solid>& solids, bool opaque, bool transparent,
                float opacity) const;

  ShaderProgram backdrop_, solid_, point_, line_;
  VertexArray nothing_;
  std::array<VertexArray, kShapeCount> shapes_;
  std::array<GLsizei, kShapeCount> counts_{};
};

}  // namespace palpate::view
