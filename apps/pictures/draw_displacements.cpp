// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_displacements.h"

#include <vtkActor.h>
#include <vtkCellArray.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkProperty.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "canvas.h"
#include "input_checks.h"
#include "palpate/core/quantile.h"
#include "surface_view.h"
#include "ticks.h"

namespace palpate::pictures {
namespace {

constexpr double kPointDiameter = 6;    ///< px, of a contact without a displacement
constexpr double kLargestCircle = 0.9;  ///< diameter, of the median distance of nearest contacts
constexpr double kAloneCircle = 0.1;    ///< the same if there is one contact, of the diagonal
constexpr double kCircleOpacity = 0.75;
constexpr double kCircleLift = 0.05;  ///< above the surface's highest point, of its diagonal
constexpr int kCircleSides = 48;
constexpr double kSampleBarLeft = 480;  ///< px from the left of the picture

void check_displacements(const Eigen::Ref<const Eigen::Matrix3Xd>& contacts,
                         const Eigen::Ref<const Eigen::VectorXd>& displacements) {
  refuse_unless(contacts.cols() > 0, "contacts", "is empty: there is nothing to draw");
  refuse_unless(contacts.allFinite(), "contacts", "a contact is not finite");
  check_count(displacements.size(), contacts.cols(), "displacements");
  refuse_unless((displacements.array() > 0 && displacements.array().isFinite()).any(),
                "displacements", "none is finite and above zero");
}

/// [mm] median over the contacts of the distance to the nearest other one.
double typical_distance(const Eigen::Ref<const Eigen::Matrix3Xd>& contacts, double diagonal) {
  if (contacts.cols() < 2) return kAloneCircle * diagonal / kLargestCircle;
  std::vector<double> nearest;
  nearest.reserve(static_cast<std::size_t>(contacts.cols()));
  for (Eigen::Index i = 0; i < contacts.cols(); ++i) {
    Eigen::VectorXd squares = (contacts.colwise() - contacts.col(i)).colwise().squaredNorm();
    squares(i) = std::numeric_limits<double>::infinity();
    nearest.push_back(std::sqrt(squares.minCoeff()));
  }
  return median(nearest);
}

/// Flat discs that face the viewer, with centres `at` (3 x N) and `radii` (N), all in mm.
vtkSmartPointer<vtkActor> disc_actor(const Eigen::Matrix3Xd& at, const Eigen::VectorXd& radii,
                                     const ViewAxes& axes, const Rgb& color) {
  const vtkNew<vtkPoints> points;
  const vtkNew<vtkCellArray> discs;
  for (Eigen::Index i = 0; i < at.cols(); ++i) {
    discs->InsertNextCell(kCircleSides);
    for (int side = 0; side < kCircleSides; ++side) {
      const double angle = 2 * std::numbers::pi * side / kCircleSides;
      const Eigen::Vector3d point =
          at.col(i) +
          radii(i) * (std::cos(angle) * axes.row(0) + std::sin(angle) * axes.row(1)).transpose();
      discs->InsertCellPoint(points->InsertNextPoint(point.data()));
    }
  }
  const vtkNew<vtkPolyData> shape;
  shape->SetPoints(points);
  shape->SetPolys(discs);
  vtkSmartPointer<vtkActor> actor = plain_actor(shape, color);
  actor->GetProperty()->LightingOff();
  return actor;
}

}  // namespace

void draw_displacements(const std::filesystem::path& png, const geometry::TriangleMesh& surface,
                        const Eigen::Ref<const Eigen::Matrix3Xd>& contacts,
                        const Eigen::Ref<const Eigen::VectorXd>& displacements,
                        const std::string& title) {
  check_surface(surface, "surface");
  check_displacements(contacts, displacements);
  const Eigen::VectorXd known =
      displacements.array().isFinite().select(displacements, 0).cwiseMax(0);
  Canvas canvas(Canvas::kHeight, title,
                "at most " + format_value(known.maxCoeff(), 0.1) + " mm, at " +
                    std::to_string(contacts.cols()) + " contacts");
  const geometry::TriangleMesh clean = without_strays(surface);
  const Eigen::Matrix3Xd& seen = clean.vertices;
  const double diagonal = (seen.rowwise().maxCoeff() - seen.rowwise().minCoeff()).norm();
  Eigen::Matrix3Xd all(3, seen.cols() + contacts.cols());
  all << seen, contacts;
  SurfaceView view(canvas, {0, 0, Canvas::kWidth, canvas.top()}, outer_side(clean), all);
  view.add(matt_surface(to_poly_data(clean)));

  const double mm_per_mm = kLargestCircle * typical_distance(contacts, diagonal) / known.maxCoeff();
  const Eigen::Vector3d towards = view.axes().row(2);
  // In front of all the surface, or a slope would hide a part of a large circle.
  const Eigen::RowVectorXd heights = towards.transpose() * contacts;
  const double top = (towards.transpose() * all).maxCoeff() + kCircleLift * diagonal;
  const Eigen::Matrix3Xd lifted = contacts + towards * (top - heights.array()).matrix();
  const vtkSmartPointer<vtkActor> circles =
      disc_actor(lifted, mm_per_mm / 2 * known, view.axes(), kBlue);
  circles->GetProperty()->SetOpacity(kCircleOpacity);
  view.add(circles);
  view.add(
      disc_actor(lifted.colwise() + kCircleLift * diagonal * towards,
                 Eigen::VectorXd::Constant(contacts.cols(), kPointDiameter / 2 / view.px_per_mm()),
                 view.axes(), kBlack));
  view.add_scale_bar();
  const double shown = round_down(known.maxCoeff());
  canvas.add_bar({kSampleBarLeft, SurfaceView::kCornerGap}, shown * mm_per_mm * view.px_per_mm(),
                 "diameter for " + format_value(shown, shown) + " mm");
  view.add_axes();
  canvas.write(png);
}

}  // namespace palpate::pictures
