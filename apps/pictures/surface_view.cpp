// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "surface_view.h"

#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkLight.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataNormals.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "ticks.h"

namespace palpate::pictures {
namespace {

constexpr double kTurn = 25 * std::numbers::pi / 180;  ///< [rad] about the vertical
constexpr double kRise = 15 * std::numbers::pi / 180;  ///< [rad] above the horizontal

/// Of the panel that the scene may fill.
constexpr double kFill = 0.9;

/// [px] length of a unit axis in the corner.
constexpr double kAxisLength = 44;

constexpr double kNameGap = 11;  ///< px from the end of an axis to its name

/// Of the panel's width that the scale bar may take.
constexpr double kLongestBar = 0.2;

constexpr Rgb kNeutral{190, 187, 180};

void add_light(vtkRenderer* panel, const Eigen::Vector3d& from, double intensity) {
  const vtkNew<vtkLight> light;
  light->SetLightTypeToCameraLight();
  // In a camera light's axes the camera is at (0, 0, 1) and looks at the origin.
  light->SetPosition(from.x(), from.y(), from.z());
  light->SetFocalPoint(0, 0, 0);
  light->SetIntensity(intensity);
  panel->AddLight(light);
}

/// Returns true if the mean normal points to Z, apart from the rounding of closed surfaces.
bool faces_z(const geometry::TriangleMesh& mesh) {
  constexpr double kLeast = 0.01;  // of a unit normal
  double along = 0, area = 0;
  for (const auto& triangle : mesh.triangles.colwise()) {
    const Eigen::Vector3d corner = mesh.vertices.col(triangle[0]);
    const Eigen::Vector3d normal =
        (mesh.vertices.col(triangle[1]) - corner).cross(mesh.vertices.col(triangle[2]) - corner);
    along += normal.z();
    area += normal.norm();
  }
  return along > kLeast * area;
}

}  // namespace

ViewAxes outer_side(const geometry::TriangleMesh& mesh) {
  const Eigen::Vector3d towards(std::sin(kTurn) * std::cos(kRise), -std::sin(kRise),
                                -std::cos(kTurn) * std::cos(kRise));
  const Eigen::Vector3d right = (-Eigen::Vector3d::UnitY()).cross(towards).normalized();
  ViewAxes axes;
  axes << right.transpose(), towards.cross(right).transpose(), towards.transpose();
  if (faces_z(mesh)) axes.rightCols<2>() *= -1;  // half a turn about X
  return axes;
}

SurfaceView::SurfaceView(Canvas& canvas, const Box& box, const ViewAxes& axes,
                         const Eigen::Ref<const Eigen::Matrix3Xd>& points)
    : canvas_(canvas), box_(box), axes_(axes), panel_(canvas.add_panel(box)) {
  const Eigen::Matrix3Xd seen = axes * points;
  const Eigen::Vector3d low = seen.rowwise().minCoeff();
  const Eigen::Vector3d high = seen.rowwise().maxCoeff();
  const Eigen::Vector3d size = high - low;
  const double height = box.height - kFooter;
  const double scale = std::min(box.width / size.x(), height / size.y());
  // A single point, or a line that is seen from its end, has no size.
  px_per_mm_ = std::isfinite(scale) ? kFill * scale : 1;
  // The panel's middle is below the scene's.
  const Eigen::Vector3d middle =
      (low + high) / 2 - Eigen::Vector3d::UnitY() * kFooter / 2 / px_per_mm_;
  const Eigen::Vector3d center = axes.transpose() * middle;

  vtkCamera* camera = panel_->GetActiveCamera();
  camera->ParallelProjectionOn();
  camera->SetFocalPoint(center.data());
  const Eigen::Vector3d eye = center + axes.row(2).transpose() * (size.norm() + 1);
  camera->SetPosition(eye.data());
  const Eigen::Vector3d up = axes.row(1);
  camera->SetViewUp(up.data());
  camera->SetParallelScale(box.height / px_per_mm_ / 2);

  panel_->AutomaticLightCreationOff();
  panel_->RemoveAllLights();
  add_light(panel_, {-0.6, 0.7, 1}, 0.85);
  add_light(panel_, {0.3, -0.1, 1}, 0.4);
}

void SurfaceView::add(vtkProp* prop) {
  panel_->AddViewProp(prop);
  panel_->ResetCameraClippingRange();
}

void SurfaceView::add_scale_bar() {
  const double length = round_down(kLongestBar * box_.width / px_per_mm_);
  canvas_.add_bar({box_.x + kCornerGap, box_.y + kCornerGap}, length * px_per_mm_,
                  format_value(length, length) + " mm");
}

void SurfaceView::add_axes() {
  const double room = kCornerGap + kAxisLength;
  const Eigen::Vector2d root(box_.x + box_.width - room, box_.y + room);
  constexpr std::array<const char*, 3> kNames{"X", "Y", "Z"};
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector2d direction = axes_.col(axis).head<2>();
    const Eigen::Vector2d tip = root + kAxisLength * direction;
    Eigen::Matrix2Xd line(2, 2);
    line << root, tip;
    canvas_.add_line(line, kBlack, 2);
    canvas_.add_text(tip + kNameGap * direction.normalized(),
                     kNames[static_cast<std::size_t>(axis)]);
  }
}

geometry::TriangleMesh without_strays(geometry::TriangleMesh mesh) {
  std::vector<bool> used(static_cast<std::size_t>(mesh.vertices.cols()), false);
  for (const int vertex : mesh.triangles.reshaped()) {
    used[static_cast<std::size_t>(vertex)] = true;
  }
  const Eigen::Vector3d place = mesh.vertices.col(mesh.triangles(0, 0));
  for (Eigen::Index vertex = 0; vertex < mesh.vertices.cols(); ++vertex) {
    if (!used[static_cast<std::size_t>(vertex)]) {
      mesh.vertices.col(vertex) = place;
    }
  }
  return mesh;
}

vtkSmartPointer<vtkPolyData> to_poly_data(const geometry::TriangleMesh& mesh) {
  const vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (const auto& vertex : mesh.vertices.colwise()) {
    points->InsertNextPoint(vertex.x(), vertex.y(), vertex.z());
  }
  const vtkNew<vtkCellArray> triangles;
  for (const auto& corners : mesh.triangles.colwise()) {
    triangles->InsertNextCell({corners.x(), corners.y(), corners.z()});
  }
  auto surface = vtkSmartPointer<vtkPolyData>::New();
  surface->SetPoints(points);
  surface->SetPolys(triangles);
  return surface;
}

vtkSmartPointer<vtkActor> plain_actor(vtkPolyData* shape, const Rgb& color) {
  const vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(shape);
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(color[0] / 255.0, color[1] / 255.0, color[2] / 255.0);
  actor->GetProperty()->SetAmbient(0.15);
  actor->GetProperty()->SetDiffuse(0.9);
  actor->GetProperty()->SetSpecular(0);
  return actor;
}

vtkSmartPointer<vtkActor> matt_surface(vtkPolyData* surface) {
  const vtkNew<vtkPolyDataNormals> normals;
  normals->SetInputData(surface);
  normals->SplittingOff();
  normals->ConsistencyOff();
  normals->Update();
  vtkSmartPointer<vtkActor> actor = plain_actor(normals->GetOutput(), kNeutral);
  actor->GetProperty()->SetInterpolationToPhong();
  return actor;
}

}  // namespace palpate::pictures
