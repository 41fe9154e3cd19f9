// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_mesh.h"

#include <vtkActor.h>
#include <vtkPolyData.h>

#include <optional>
#include <utility>
#include <vector>

#include "background.h"
#include "canvas.h"
#include "input_checks.h"
#include "surface_view.h"
#include "ticks.h"

namespace palpate::pictures {
namespace {

/// \return depth from which triangles were left out [mm], if there is a background.
std::optional<double> leave_out_background(geometry::TriangleMesh& mesh) {
  const auto depths = mesh.vertices.row(2);
  const std::optional<double> background = background_border({depths.begin(), depths.end()});
  if (!background) return {};
  std::vector<Eigen::Index> kept;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    if (depths(mesh.triangles.col(t)).maxCoeff() < *background) kept.push_back(t);
  }
  if (kept.empty()) return {};
  mesh.triangles = mesh.triangles(Eigen::all, kept).eval();
  mesh = without_strays(std::move(mesh));
  return background;
}

}  // namespace

void draw_mesh(const std::filesystem::path& png, const geometry::TriangleMesh& mesh,
               const std::string& title, MeshPart part) {
  check_surface(mesh, "mesh");
  std::string subtitle = std::to_string(mesh.vertices.cols()) + " vertices, " +
                         std::to_string(mesh.triangles.cols()) + " triangles";
  geometry::TriangleMesh clean = without_strays(mesh);
  if (part == MeshPart::object) {
    if (const std::optional<double> background = leave_out_background(clean))
      subtitle += "; not shown: what is farther than " + format_value(*background, 1) + " mm";
  }
  Canvas canvas(Canvas::kHeight, title, subtitle);
  SurfaceView view(canvas, {0, 0, Canvas::kWidth, canvas.top()}, outer_side(clean), clean.vertices);
  view.add(matt_surface(to_poly_data(clean)));
  view.add_scale_bar();
  view.add_axes();
  canvas.write(png);
}

}  // namespace palpate::pictures
