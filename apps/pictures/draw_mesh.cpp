// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_mesh.h"

#include <vtkActor.h>
#include <vtkPolyData.h>

#include "canvas.h"
#include "input_checks.h"
#include "surface_view.h"

namespace palpate::pictures {
void draw_mesh(const std::filesystem::path& png, const geometry::TriangleMesh& mesh,
               const std::string& title) {
  check_surface(mesh, "mesh");
  Canvas canvas(Canvas::kHeight, title,
                std::to_string(mesh.vertices.cols()) + " vertices, " +
                    std::to_string(mesh.triangles.cols()) + " triangles");
  const geometry::TriangleMesh clean = without_strays(mesh);
  SurfaceView view(canvas, {0, 0, Canvas::kWidth, canvas.top()}, camera_side(), clean.vertices);
  view.add(matt_surface(to_poly_data(clean)));
  view.add_scale_bar();
  view.add_axes();
  canvas.write(png);
}

}  // namespace palpate::pictures
