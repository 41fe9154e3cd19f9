// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "force_field_scene.h"

#include <vtkActor.h>
#include <vtkArrowSource.h>
#include <vtkCellArray.h>
#include <vtkConeSource.h>
#include <vtkDoubleArray.h>
#include <vtkGlyph3D.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "surface_view.h"
#include "ticks.h"

namespace palpate::pictures {
namespace {

/// Of the extent of the displacements: the longest arrow, the cone's length, and how far the fitted
/// lines are moved towards the viewer, before the arrows (nothing moves on the picture).
constexpr double kLongestArrow = 0.25;
constexpr double kConeLength = 0.3;
constexpr double kLineLift = 0.05;

constexpr double kNewtonBarLeft = 200;  ///< px from the left of the panel
constexpr double kConeOpacity = 0.25;
constexpr double kPlaneWidth = 1.3;   ///< px
constexpr double kFittedWidth = 1.3;  ///< px
constexpr double kAxisWidth = 2.5;    ///< px

/// [mm] extent that is drawn when all displacements are zero.
constexpr double kSmallestExtent = 1e-3;

constexpr double kSceneTurn = 30 * std::numbers::pi / 180;  ///< [rad] about the friction axis
constexpr double kSceneRise = 18 * std::numbers::pi / 180;  ///< [rad] above the tangent plane

/// Cells of the grid on the tangent plane to each side of the contact, at most.
constexpr int kGridCells = 4;

struct Scale {
  double extent = 0;         // [mm] diagonal of the displacements with the contact
  double mm_per_newton = 0;  // of the arrows
};

Scale choose_scale(const ContactSamples& samples) {
  const Eigen::Vector3d low = samples.displacements.rowwise().minCoeff().cwiseMin(0);
  const Eigen::Vector3d high = samples.displacements.rowwise().maxCoeff().cwiseMax(0);
  const double extent = std::max((high - low).norm(), kSmallestExtent);
  const double largest = samples.forces.colwise().norm().maxCoeff();
  return {extent, largest > 0 ? kLongestArrow * extent / largest : 1};
}

/// Looks along the tangent plane, a little from outside, with the object below.
ViewAxes side_view(const Eigen::Vector3d& axis) {
  const Eigen::Vector3d up = -axis;
  Eigen::Vector3d right = Eigen::Vector3d::UnitX() - up * up.x();
  if (right.norm() < 0.1) {
    right = Eigen::Vector3d::UnitY() - up * up.y();
  }
  right = Eigen::AngleAxisd(kSceneTurn, up) * right.normalized();
  const Eigen::Vector3d level = right.cross(up);
  ViewAxes axes;
  axes.row(0) = right;
  axes.row(2) = std::cos(kSceneRise) * level + std::sin(kSceneRise) * up;
  axes.row(1) = Eigen::Vector3d(axes.row(2)).cross(right);
  return axes;
}

/// [mm] the arrows of the samples that are or are not on the boundary: root and direction.
vtkSmartPointer<vtkPolyData> arrow_roots(const FittedSamples& contact, const Scale& scale,
                                         bool on_boundary) {
  const vtkNew<vtkPoints> roots;
  const vtkNew<vtkDoubleArray> directions;
  directions->SetNumberOfComponents(3);
  for (Eigen::Index sample = 0; sample < contact.fitted.cols(); ++sample) {
    if (contact.samples.on_boundary[static_cast<std::size_t>(sample)] == on_boundary) {
      roots->InsertNextPoint(contact.samples.displacements.col(sample).data());
      const Eigen::Vector3d direction = scale.mm_per_newton * contact.samples.forces.col(sample);
      directions->InsertNextTypedTuple(direction.data());
    }
  }
  auto shape = vtkSmartPointer<vtkPolyData>::New();
  shape->SetPoints(roots);
  shape->GetPointData()->SetVectors(directions);
  return shape;
}

vtkSmartPointer<vtkActor> arrow_actor(const FittedSamples& contact, const Scale& scale,
                                      bool on_boundary) {
  const vtkNew<vtkArrowSource> arrow;
  arrow->SetTipResolution(16);
  arrow->SetShaftResolution(12);
  arrow->SetShaftRadius(0.025);
  arrow->SetTipRadius(0.08);
  arrow->SetTipLength(0.3);
  const vtkNew<vtkGlyph3D> glyphs;
  glyphs->SetInputData(arrow_roots(contact, scale, on_boundary));
  glyphs->SetSourceConnection(arrow->GetOutputPort());
  glyphs->SetVectorModeToUseVector();
  glyphs->SetScaleModeToScaleByVector();
  glyphs->Update();
  return plain_actor(glyphs->GetOutput(), on_boundary ? kBoundaryColor : kStickingColor);
}

/// Lines from column 2k to column 2k + 1.
vtkSmartPointer<vtkActor> line_actor(const Eigen::Ref<const Eigen::Matrix3Xd>& ends,
                                     const Rgb& color, double width) {
  const vtkNew<vtkPoints> points;
  const vtkNew<vtkCellArray> lines;
  for (Eigen::Index end = 0; end < ends.cols(); ++end) {
    points->InsertNextPoint(ends(0, end), ends(1, end), ends(2, end));
    if (end % 2 == 1) {
      lines->InsertNextCell({end - 1, end});
    }
  }
  const vtkNew<vtkPolyData> shape;
  shape->SetPoints(points);
  shape->SetLines(lines);
  vtkSmartPointer<vtkActor> actor = plain_actor(shape, color);
  actor->GetProperty()->LightingOff();
  actor->GetProperty()->SetLineWidth(static_cast<float>(width));
  return actor;
}

Eigen::Matrix3Xd fitted_lines(const FittedSamples& contact, const Scale& scale,
                              const Eigen::Vector3d& lift) {
  Eigen::Matrix3Xd ends(3, 2 * contact.fitted.cols());
  for (Eigen::Index sample = 0; sample < contact.fitted.cols(); ++sample) {
    const Eigen::Vector3d root = contact.samples.displacements.col(sample) + lift;
    ends.col(2 * sample) = root;
    ends.col(2 * sample + 1) = root + scale.mm_per_newton * contact.fitted.col(sample);
  }
  return ends;
}

vtkSmartPointer<vtkActor> cone_actor(const FittedSamples& contact, const Scale& scale) {
  const double length = kConeLength * scale.extent;
  const vtkNew<vtkConeSource> cone;
  cone->SetHeight(length);
  cone->SetRadius(length * contact.friction_coefficient);
  cone->SetResolution(72);
  cone->CappingOff();
  // VTK's direction runs from the base to the tip, its centre is half way.
  const Eigen::Vector3d back = -contact.axis;
  const Eigen::Vector3d middle = contact.axis * length / 2;
  cone->SetDirection(back.x(), back.y(), back.z());
  cone->SetCenter(middle.x(), middle.y(), middle.z());
  cone->Update();
  vtkSmartPointer<vtkActor> actor = plain_actor(cone->GetOutput(), kConeColor);
  actor->GetProperty()->SetOpacity(kConeOpacity);
  return actor;
}

/// The grid's lines on the plane through the contact, `side` mm to each side, `step` apart.
Eigen::Matrix3Xd grid_lines(const Eigen::Vector3d& axis, double side, double step) {
  const Eigen::Vector3d one = axis.unitOrthogonal();
  const Eigen::Vector3d other = axis.cross(one);
  const auto count = std::lround(side / step);
  Eigen::Matrix3Xd ends(3, 4 * (2 * count + 1));
  Eigen::Index end = 0;
  for (long line = -count; line <= count; ++line) {
    const double at = static_cast<double>(line) * step;
    ends.col(end++) = at * one - side * other;
    ends.col(end++) = at * one + side * other;
    ends.col(end++) = at * other - side * one;
    ends.col(end++) = at * other + side * one;
  }
  return ends;
}

}  // namespace

double add_force_field_scene(Canvas& canvas, const Box& box, const FittedSamples& contact) {
  const Scale scale = choose_scale(contact.samples);
  const ViewAxes axes = side_view(contact.axis);
  const Eigen::Vector3d towards = axes.row(2);

  const Eigen::Matrix3Xd& displacements = contact.samples.displacements;
  const Eigen::VectorXd depths = displacements.transpose() * contact.axis;
  const double sideways =
      (displacements - contact.axis * depths.transpose()).colwise().norm().maxCoeff();
  const double step = round_down(std::max(sideways, scale.extent / kGridCells) / 2);
  const double side = step * std::ceil(sideways / step);
  const Eigen::Matrix3Xd grid = grid_lines(contact.axis, side, step);

  const Eigen::Matrix3Xd fitted = fitted_lines(contact, scale, kLineLift * scale.extent * towards);
  Eigen::Matrix3Xd all(3, 2 * displacements.cols() + fitted.cols() + grid.cols());
  all << displacements, displacements + scale.mm_per_newton * contact.samples.forces, fitted, grid;
  SurfaceView view(canvas, box, axes, all);
  view.add(line_actor(grid, kPlaneColor, kPlaneWidth));
  view.add(arrow_actor(contact, scale, false));
  view.add(arrow_actor(contact, scale, true));
  view.add(line_actor(fitted, kFittedColor, kFittedWidth));
  if (contact.friction_coefficient > 0) view.add(cone_actor(contact, scale));
  Eigen::Matrix3Xd axis_line(3, 2);
  axis_line << Eigen::Vector3d::Zero(), contact.axis * std::max(depths.maxCoeff(), 0.0);
  view.add(line_actor(axis_line, kConeColor, kAxisWidth));
  view.add_scale_bar();
  const double newton = round_down(kLongestArrow * scale.extent / scale.mm_per_newton);
  canvas.add_bar({box.x + kNewtonBarLeft, box.y + SurfaceView::kCornerGap},
                 newton * scale.mm_per_newton * view.px_per_mm(),
                 format_value(newton, newton) + " N");
  view.add_axes();
  return step;
}

}  // namespace palpate::pictures
