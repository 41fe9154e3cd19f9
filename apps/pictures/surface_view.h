// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vtkSmartPointer.h>

#include <Eigen/Core>

#include "canvas.h"
#include "palpate/geometry/triangle_mesh.h"

class vtkActor;
class vtkProp;
class vtkPolyData;

namespace palpate::pictures {

/// A rotation whose rows are the directions right, up and towards the viewer, in the axes of the
/// scene.
using ViewAxes = Eigen::Matrix3d;

/// View of a camera at the origin (X right, Y down, Z away), rotated slightly to the side and
/// upwards to show relief. A surface that faces Z on the whole, such as one measured with Z up, is
/// seen from its other side, with Y up.
[[nodiscard]] ViewAxes outer_side(const geometry::TriangleMesh& mesh);

/// A panel with a 3-D scene in parallel projection, so that one scale bar is valid everywhere.
class SurfaceView {
 public:
  static constexpr double kCornerGap = 28;  ///< px from the panel's corner to the drawing in it
  /// px at the lower end of the panel where the scene does not reach: room for bars and axes.
  static constexpr double kFooter = 100;

  /// Creates a panel of `canvas` that shows all of `points` [mm] (3 x N, finite), lit from the
  /// viewer.
  SurfaceView(Canvas& canvas, const Box& box, const ViewAxes& axes,
              const Eigen::Ref<const Eigen::Matrix3Xd>& points);

  void add(vtkProp* prop);
  /// Draws a bar with its length in mm in the lower left corner.
  void add_scale_bar();
  /// Draws the scene's axes in the lower right corner.
  void add_axes();
  [[nodiscard]] double px_per_mm() const { return px_per_mm_; }
  [[nodiscard]] const ViewAxes& axes() const { return axes_; }

 private:
  Canvas& canvas_;
  Box box_;
  ViewAxes axes_;
  double px_per_mm_ = 1;
  vtkRenderer* panel_;
};

/// Moves the vertices that no triangle uses (they may be anywhere, or NaN) to one that is used, so
/// that they do not affect the view.
[[nodiscard]] geometry::TriangleMesh without_strays(geometry::TriangleMesh mesh);

[[nodiscard]] vtkSmartPointer<vtkPolyData> to_poly_data(const geometry::TriangleMesh& mesh);

/// A matt actor with smooth normals, visible from both sides, in the cell colours of `surface` if
/// it has any, else in a neutral colour.
[[nodiscard]] vtkSmartPointer<vtkActor> matt_surface(vtkPolyData* surface);

/// A matt actor of one colour.
[[nodiscard]] vtkSmartPointer<vtkActor> plain_actor(vtkPolyData* shape, const Rgb& color);

}  // namespace palpate::pictures
