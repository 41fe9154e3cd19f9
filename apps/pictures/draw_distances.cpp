// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_distances.h"

#include <vtkActor.h>
#include <vtkCellData.h>
#include <vtkPolyData.h>
#include <vtkProperty.h>
#include <vtkUnsignedCharArray.h>

#include <cmath>

#include "canvas.h"
#include "color_scale.h"
#include "input_checks.h"
#include "palpate/core/require.h"
#include "surface_view.h"

namespace palpate::pictures {
namespace {

constexpr double kScaleRoom = 190;   ///< px at the right, for the scale
constexpr double kScaleMargin = 40;  ///< px above and below the scale

/// Parts of a colour that are its own, and that come from the light: relief shows, and the colour
/// can still be read.
constexpr double kOwn = 0.62;
constexpr double kLit = 0.4;

/// The colour of each triangle, as VTK takes it.
vtkSmartPointer<vtkUnsignedCharArray> colors_of(const Eigen::Ref<const Eigen::VectorXd>& distances,
                                                double low, double high, ColorMap map) {
  auto colors = vtkSmartPointer<vtkUnsignedCharArray>::New();
  colors->SetNumberOfComponents(3);
  for (const double distance : distances) {
    const double fraction =
        std::isfinite(distance) ? (distance - low) / (high - low) : std::nan("");
    const Rgb color = color_at(map, fraction);
    colors->InsertNextTypedTuple(color.data());
  }
  return colors;
}

}  // namespace

void draw_distances(const std::filesystem::path& png, const geometry::TriangleMesh& mesh,
                    const Eigen::Ref<const Eigen::VectorXd>& distances,
                    const DistancePicture& picture) {
  check_surface(mesh, "mesh");
  check_count(distances.size(), mesh.triangles.cols(), "distances");
  check_some_finite(distances, "distances");
  require("DistancePicture::limit", picture.limit, above(0).finite(), "mm");
  const double low = picture.one_sided ? 0 : -picture.limit;
  const ColorMap map = picture.one_sided ? ColorMap::sequential : ColorMap::diverging;
  Canvas canvas(Canvas::kHeight, picture.title, picture.subtitle);
  const geometry::TriangleMesh clean = without_strays(mesh);
  const double width = Canvas::kWidth - kScaleRoom;
  SurfaceView view(canvas, {0, 0, width, canvas.top()}, outer_side(clean), clean.vertices);
  const vtkSmartPointer<vtkPolyData> surface = to_poly_data(clean);
  surface->GetCellData()->SetScalars(colors_of(distances, low, picture.limit, map));
  const vtkSmartPointer<vtkActor> actor = matt_surface(surface);
  actor->GetProperty()->SetAmbient(kOwn);
  actor->GetProperty()->SetDiffuse(kLit);
  view.add(actor);
  view.add_scale_bar();
  view.add_axes();
  add_color_scale(canvas, {width, kScaleMargin, kScaleWidth, canvas.top() - 2 * kScaleMargin},
                  {.low = low,
                   .high = picture.limit,
                   .map = map,
                   .scale = picture.scale,
                   .any_below = (distances.array() < low).any(),
                   .any_above = (distances.array() > picture.limit).any()});
  canvas.write(png);
}

}  // namespace palpate::pictures
