// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_contacts.h"

#include <vtkActor.h>
#include <vtkBillboardTextActor3D.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkGlyph3D.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkSphereSource.h>
#include <vtkTextProperty.h>
#include <vtkUnsignedCharArray.h>

#include <array>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "canvas.h"
#include "cell_coloring.h"
#include "input_checks.h"
#include "surface_view.h"

namespace palpate::pictures {
namespace {

constexpr double kContactRadius = 6;  ///< px
constexpr double kEdgeWidth = 2;      ///< px
constexpr int kNumberSize = 15;       ///< px

/// The part of a cell's colour that does not depend on the light.
constexpr double kCellAmbient = 0.3;
/// And the part that does.
constexpr double kCellDiffuse = 0.75;

/// Shift of edges, contacts and numbers towards the viewer, relative to the surface's diagonal:
/// edges are straight and pass below a surface that bulges. The view has no perspective, so they
/// stay in place on the picture.
constexpr double kLift = 0.05;

/// Soft colours for areas that carry text (after the "light" ones of Tol 2021).
constexpr std::array<Rgb, 8> kCellColors{{{119, 170, 221},
                                          {238, 221, 136},
                                          {68, 187, 153},
                                          {255, 170, 187},
                                          {153, 221, 255},
                                          {187, 204, 51},
                                          {238, 136, 102},
                                          {196, 182, 220}}};

void check_input(const geometry::TriangleMesh& surface,
                 const Eigen::Ref<const Eigen::VectorXi>& labels,
                 const geometry::TriangleMesh& contact_mesh) {
  check_surface(surface, "surface");
  check_count(labels.size(), surface.vertices.cols(), "labels");
  refuse_unless(contact_mesh.vertices.cols() > 0, "contact mesh",
                "has no contact: there is nothing to draw");
  refuse_unless(contact_mesh.vertices.allFinite(), "contact mesh", "a contact is not finite");
  if (contact_mesh.triangles.cols() > 0) {
    check_surface(contact_mesh, "contact mesh");
  }
  for (Eigen::Index vertex = 0; vertex < labels.size(); ++vertex) {
    refuse_unless(labels(vertex) >= -1 && labels(vertex) < contact_mesh.vertices.cols(), "labels",
                  "vertex " + std::to_string(vertex) + " has " + std::to_string(labels(vertex)) +
                      ": -1 or one of the " + std::to_string(contact_mesh.vertices.cols()) +
                      " contacts is needed");
  }
}

/// The surface in pieces of one cell each: a triangle whose corners belong to several cells is cut
/// at the middles of its sides and at its centre, so that borders between cells are sharp.
class CellSurface {
 public:
  CellSurface(const geometry::TriangleMesh& surface,
              const Eigen::Ref<const Eigen::VectorXi>& labels, const std::vector<int>& colors)
      : mesh_(surface), labels_(labels), colors_(colors), shape_(to_poly_data(surface)) {
    shades_->SetNumberOfComponents(3);
    for (const auto& corners : surface.triangles.colwise()) {
      add_triangle(corners);
    }
    shape_->SetPolys(pieces_);
    shape_->GetCellData()->SetScalars(shades_);
  }

  [[nodiscard]] vtkPolyData* shape() const { return shape_; }

 private:
  void add_triangle(const Eigen::Vector3i& corners) {
    const Eigen::Vector3i cells(labels_(corners(0)), labels_(corners(1)), labels_(corners(2)));
    if (cells(0) == cells(1) && cells(1) == cells(2)) {
      pieces_->InsertNextCell({corners(0), corners(1), corners(2)});
      add_shade(cells(0));
      return;
    }
    const Eigen::Vector3d center = mesh_.vertices(Eigen::all, corners).rowwise().mean();
    const vtkIdType middle = shape_->GetPoints()->InsertNextPoint(center.data());
    for (int corner = 0; corner < 3; ++corner) {
      const int before = corners((corner + 2) % 3);
      const int after = corners((corner + 1) % 3);
      pieces_->InsertNextCell({corners(corner), half_way(corners(corner), after), middle,
                               half_way(before, corners(corner))});
      add_shade(cells(corner));
    }
  }

  /// The point in the middle of a side: one for both of its triangles, for the sake of smooth
  /// normals.
  vtkIdType half_way(int one, int other) {
    const auto [place, is_new] = half_ways_.try_emplace(std::minmax(one, other), 0);
    if (is_new) {
      const Eigen::Vector3d point = (mesh_.vertices.col(one) + mesh_.vertices.col(other)) / 2;
      place->second = shape_->GetPoints()->InsertNextPoint(point.data());
    }
    return place->second;
  }

  void add_shade(int cell) {
    const Rgb& color =
        cell < 0 ? kUnknownColor
                 : kCellColors[static_cast<std::size_t>(colors_[static_cast<std::size_t>(cell)])];
    shades_->InsertNextTypedTuple(color.data());
  }

  const geometry::TriangleMesh& mesh_;
  const Eigen::Ref<const Eigen::VectorXi>& labels_;
  const std::vector<int>& colors_;
  vtkSmartPointer<vtkPolyData> shape_;
  vtkNew<vtkCellArray> pieces_;
  vtkNew<vtkUnsignedCharArray> shades_;
  std::map<std::pair<int, int>, vtkIdType> half_ways_;
};

vtkSmartPointer<vtkActor> edge_actor(const geometry::TriangleMesh& contacts) {
  std::set<std::pair<int, int>> edges;
  for (const auto& corners : contacts.triangles.colwise()) {
    for (int corner = 0; corner < 3; ++corner) {
      edges.insert(std::minmax(corners(corner), corners((corner + 1) % 3)));
    }
  }
  const vtkNew<vtkCellArray> lines;
  for (const auto& [one, other] : edges) {
    lines->InsertNextCell({one, other});
  }
  const vtkNew<vtkPolyData> shape;
  shape->SetPoints(to_poly_data(contacts)->GetPoints());
  shape->SetLines(lines);
  vtkSmartPointer<vtkActor> actor = plain_actor(shape, {50, 50, 50});
  actor->GetProperty()->LightingOff();
  actor->GetProperty()->SetLineWidth(kEdgeWidth);
  return actor;
}

vtkSmartPointer<vtkActor> sphere_actor(const geometry::TriangleMesh& contacts, double radius) {
  const vtkNew<vtkSphereSource> sphere;
  sphere->SetRadius(radius);
  sphere->SetThetaResolution(24);
  sphere->SetPhiResolution(24);
  const vtkNew<vtkGlyph3D> glyphs;
  glyphs->SetInputData(to_poly_data(contacts));
  glyphs->SetSourceConnection(sphere->GetOutputPort());
  glyphs->ScalingOff();
  glyphs->Update();
  return plain_actor(glyphs->GetOutput(), kBlack);
}

vtkSmartPointer<vtkBillboardTextActor3D> number_actor(const Eigen::Vector3d& at, long long number) {
  auto actor = vtkSmartPointer<vtkBillboardTextActor3D>::New();
  actor->SetInput(std::to_string(number).c_str());
  actor->SetPosition(at.x(), at.y(), at.z());
  actor->SetDisplayOffset(static_cast<int>(kContactRadius) + 2,
                          static_cast<int>(kContactRadius) + 2);
  vtkTextProperty* text = actor->GetTextProperty();
  text->SetFontFamilyToArial();
  text->SetFontSize(kNumberSize);
  text->SetBold(1);
  text->SetColor(0, 0, 0);
  return actor;
}

}  // namespace

void draw_contacts(const std::filesystem::path& png, const geometry::TriangleMesh& surface,
                   const Eigen::Ref<const Eigen::VectorXi>& labels,
                   const geometry::TriangleMesh& contact_mesh, const std::vector<long long>& ids,
                   const std::string& title) {
  check_input(surface, labels, contact_mesh);
  check_count(static_cast<Eigen::Index>(ids.size()), contact_mesh.vertices.cols(), "ids");
  const std::string contacts = std::to_string(contact_mesh.vertices.cols()) + " contacts";
  const auto triangles = contact_mesh.triangles.cols();
  Canvas canvas(Canvas::kHeight, title,
                triangles == 0
                    ? contacts + "; colours: the contact that is nearest along the surface"
                    : contacts + ", " + std::to_string(triangles) +
                          " triangles; colours: the contact with the largest weight");
  const geometry::TriangleMesh clean = without_strays(surface);
  const Eigen::Matrix3Xd& seen = clean.vertices;
  Eigen::Matrix3Xd all(3, seen.cols() + contact_mesh.vertices.cols());
  all << seen, contact_mesh.vertices;
  SurfaceView view(canvas, {0, 0, Canvas::kWidth, canvas.top()}, outer_side(clean), all);

  const int count = static_cast<int>(contact_mesh.vertices.cols());
  const std::vector<int> colors =
      color_cells(surface.triangles, labels, count, static_cast<int>(kCellColors.size()));
  const vtkSmartPointer<vtkActor> cells = matt_surface(CellSurface(clean, labels, colors).shape());
  // Flatter than a plain surface: here the colours say more than the relief.
  cells->GetProperty()->SetAmbient(kCellAmbient);
  cells->GetProperty()->SetDiffuse(kCellDiffuse);
  view.add(cells);

  const double diagonal = (seen.rowwise().maxCoeff() - seen.rowwise().minCoeff()).norm();
  const Eigen::Vector3d lift = kLift * diagonal * view.axes().row(2).transpose();
  geometry::TriangleMesh lifted = contact_mesh;
  lifted.vertices.colwise() += lift;
  view.add(edge_actor(lifted));
  view.add(sphere_actor(lifted, kContactRadius / view.px_per_mm()));
  for (Eigen::Index contact = 0; contact < count; ++contact) {
    view.add(
        number_actor(lifted.vertices.col(contact) + lift, ids[static_cast<std::size_t>(contact)]));
  }
  view.add_scale_bar();
  view.add_axes();
  canvas.write(png);
}

}  // namespace palpate::pictures
