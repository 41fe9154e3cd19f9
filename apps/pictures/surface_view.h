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

/// Rows: the directions that are right, up and towards the viewer on the picture, in the axes of
/// the scene; a rotation.
using ViewAxes = Eigen::Matrix3d;

/// As the camera at the origin sees (X right, Y down, Z away), turned a little to the side and
/// above, so that relief shows.
[[nodiscard]] ViewAxes camera_side();

/// A panel with a 3-D scene seen without perspective, so that one scale bar holds all over it.
class SurfaceView {
 public:
  static constexpr double kCornerGap = 28;  ///< px from the panel's corner to what stands there

  /// A panel of `canvas` whose view takes in all of `points` [mm] (3 x N, finite), lit from the
  /// viewer.
  SurfaceView(Canvas& canvas, const Box& box, const ViewAxes& axes,
              const Eigen::Ref<const Eigen::Matrix3Xd>& points);

  void add(vtkProp* prop);
  /// In the lower left corner a bar with its length in mm, in the lower right the scene's axes.
  void add_scale_bar();
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

/// The mesh with the vertices that no triangle uses (they may be anywhere, or NaN) moved onto one
/// that is used: they do not widen the view.
[[nodiscard]] geometry::TriangleMesh without_strays(geometry::TriangleMesh mesh);

[[nodiscard]] vtkSmartPointer<vtkPolyData> to_poly_data(const geometry::TriangleMesh& mesh);

/// With smooth normals, matt, seen from both sides; coloured by the cell colours of `surface` if it
/// has any, else in a neutral colour.
[[nodiscard]] vtkSmartPointer<vtkActor> matt_surface(vtkPolyData* surface);

/// An actor of `shape` in one colour, matt.
[[nodiscard]] vtkSmartPointer<vtkActor> plain_actor(vtkPolyData* shape, const Rgb& color);

}  // namespace palpate::pictures
