// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_stiffness.h"

#include <vtkActor.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkProperty.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "canvas.h"
#include "color_scale.h"
#include "input_checks.h"
#include "surface_view.h"

namespace palpate::pictures {
namespace {

constexpr double kStiffnessScaleRoom = 190;   ///< px at the right, for the scale
constexpr double kStiffnessScaleMargin = 40;  ///< px above and below the scale
constexpr double kPlaceSize = 7;              ///< px, of a contact
constexpr double kContourWidth = 4;           ///< px
/// Above the surface, of its diagonal: the line is straight where the drawn surface bulges.
constexpr double kContourLift = 0.05;
/// Least span of the colours, of the highest value: so that noise is not drawn as contrast.
constexpr double kLeastSpan = 0.1;
constexpr double kLeastSpanOfZeros = 1e-12;  ///< [N/mm]
/// Parts of a colour that are its own, and that come from the light.
constexpr double kColorOwn = 0.62, kColorLit = 0.4;

struct ColorSpan {
  double low = 0, high = 0;  // [N/mm]
};

ColorSpan span_of(const Eigen::VectorXd& stiffness) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  ColorSpan span{kInfinity, -kInfinity};
  for (const double value : stiffness) {
    if (!std::isfinite(value)) continue;
    span.low = std::min(span.low, value);
    span.high = std::max(span.high, value);
  }
  const double least = std::max(kLeastSpan * std::abs(span.high), kLeastSpanOfZeros);
  if (span.high - span.low < least) {
    const double middle = (span.low + span.high) / 2;
    span = {middle - least / 2, middle + least / 2};
  }
  return span;
}

/// The colour of each triangle, of the mean of its corners.
vtkSmartPointer<vtkUnsignedCharArray> triangle_colors(const geometry::TriangleMesh& surface,
                                                      const Eigen::VectorXd& stiffness,
                                                      const ColorSpan& span) {
  auto colors = vtkSmartPointer<vtkUnsignedCharArray>::New();
  colors->SetNumberOfComponents(3);
  for (const auto& corners : surface.triangles.colwise()) {
    const double value = stiffness(Eigen::Vector3i(corners)).mean();
    const double fraction =
        std::isfinite(value) ? (value - span.low) / (span.high - span.low) : std::nan("");
    const Rgb color = color_at(ColorMap::sequential, fraction);
    colors->InsertNextTypedTuple(color.data());
  }
  return colors;
}

/// Points, each a cell of `size` points: 1 draws dots, 2 segments.
vtkSmartPointer<vtkActor> marks_actor(const Eigen::Matrix3Xd& at, int size, const Rgb& color) {
  const vtkNew<vtkPoints> points;
  const vtkNew<vtkCellArray> cells;
  for (Eigen::Index i = 0; i < at.cols(); ++i) {
    const Eigen::Vector3d point = at.col(i);
    if (i % size == 0) cells->InsertNextCell(size);
    cells->InsertCellPoint(points->InsertNextPoint(point.data()));
  }
  const vtkNew<vtkPolyData> shape;
  shape->SetPoints(points);
  if (size == 1)
    shape->SetVerts(cells);
  else
    shape->SetLines(cells);
  vtkSmartPointer<vtkActor> actor = plain_actor(shape, color);
  actor->GetProperty()->LightingOff();
  actor->GetProperty()->SetPointSize(kPlaceSize);
  actor->GetProperty()->SetLineWidth(kContourWidth);
  return actor;
}

}  // namespace

void draw_stiffness(const std::filesystem::path& png, const geometry::TriangleMesh& surface,
                    const StiffnessPicture& picture) {
  check_surface(surface, "surface");
  check_count(picture.stiffness.size(), surface.vertices.cols(), "stiffness");
  check_some_finite(picture.stiffness, "stiffness");
  refuse_unless(picture.contacts.allFinite(), "contacts", "a contact is not finite");
  refuse_unless(picture.contour.allFinite() && picture.contour.cols() % 2 == 0, "contour",
                "it must hold two finite ends of each segment");
  const ColorSpan span = span_of(picture.stiffness);
  Canvas canvas(Canvas::kHeight, picture.title, picture.subtitle);
  const geometry::TriangleMesh clean = without_strays(surface);
  const double width = Canvas::kWidth - kStiffnessScaleRoom;
  const Eigen::Matrix3Xd& seen = clean.vertices;
  SurfaceView view(canvas, {0, 0, width, canvas.top()}, outer_side(clean), seen);
  const vtkSmartPointer<vtkPolyData> shape = to_poly_data(clean);
  shape->GetCellData()->SetScalars(triangle_colors(clean, picture.stiffness, span));
  const vtkSmartPointer<vtkActor> actor = matt_surface(shape);
  actor->GetProperty()->SetAmbient(kColorOwn);
  actor->GetProperty()->SetDiffuse(kColorLit);
  view.add(actor);
  const double diagonal = (seen.rowwise().maxCoeff() - seen.rowwise().minCoeff()).norm();
  const Eigen::Vector3d lift = kContourLift * diagonal * view.axes().row(2).transpose();
  view.add(marks_actor(picture.contacts.colwise() + lift, 1, kBlack));
  view.add(marks_actor(picture.contour.colwise() + lift, 2, kVermilion));
  view.add_scale_bar();
  view.add_axes();
  add_color_scale(
      canvas, {width, kStiffnessScaleMargin, kScaleWidth, canvas.top() - 2 * kStiffnessScaleMargin},
      {.low = span.low,
       .high = span.high,
       .map = ColorMap::sequential,
       .scale = "stiffness (N/mm)"});
  canvas.write(png);
}

}  // namespace palpate::pictures
