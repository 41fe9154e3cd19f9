// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "export/surface_file.h"

#include <fmt/format.h>

#include <utility>
#include <variant>
#include <vector>

#include "palpate/geometry/point_file.h"
#include "palpate/geometry/range_map_mesh.h"
#include "palpate/geometry/viewer_names.h"
#include "palpate/haptics/model_io.h"
#include "palpate/haptics/press_values.h"
#include "shared/surface_colors.h"
#include "surfaces/mesh_steps.h"

namespace palpate::apps {
namespace {

/// Adds numbers of the vertices, unless all are unknown.
void add_numbers(geometry::MeshFile& file, const char* name, const Eigen::VectorXd& numbers) {
  if (numbers.array().isNaN().all()) return;
  geometry::set_attribute(file.vertex_attributes,
                          {.name = name,
                           .values = std::vector<float>(numbers.begin(), numbers.end()),
                           .list_sizes = {}});
}

ExportedSurface surface_with_presses(const haptics::Model& model,
                                     const std::optional<double>& press_depth) {
  ExportedSurface surface;
  surface.file.mesh = model.surface;
  const std::optional<double> depth =
      press_depth ? press_depth : haptics::reference_press_depth(model);
  if (!depth) {
    surface.words =
        "without forces: the model does not tell how deep it was pressed; "
        "--press-depth sets a depth";
    return surface;
  }
  const haptics::PressValues values = haptics::press_values(model, *depth);
  add_numbers(surface.file, "stiffness", values.stiffness);
  add_numbers(surface.file, "force", values.force);
  add_numbers(surface.file, "force_deviation", values.deviation);
  surface.words =
      fmt::format("stiffness [N/mm] and force [N] are those of presses {:.6g} mm deep{}", *depth,
                  press_depth ? "" : "; --press-depth sets another depth");
  return surface;
}

}  // namespace

ExportedSurface surface_of(const PageCall& call, PageContent content, const SurfaceOptions& options,
                           bool with_presses, const fs::path& output) {
  ExportedSurface surface;
  geometry::MeshFile& file = surface.file;
  if (content == PageContent::model) {
    haptics::Model model = haptics::read_model(call.input);
    if (with_presses) return surface_with_presses(model, options.press_depth);
    file.mesh = std::move(model.surface);
  } else if (content == PageContent::meshes) {
    auto read = geometry::read_mesh_or_points(call.input, call.meshes);
    if (auto* const points = std::get_if<geometry::PointCloud>(&read)) {
      surface.points = std::move(*points);
      return surface;
    }
    file = std::get<geometry::MeshFile>(std::move(read));
    file.material_files = seen_from(output, call.input, std::move(file.material_files));
  } else {
    file.mesh = geometry::mesh_range_map(load_range_map(call.input, call.camera)).mesh;
    if (options.color)
      file.vertex_attributes = colors_beside(call.input, file.mesh.vertices, call.camera);
  }
  return surface;
}

std::string write_surface(const fs::path& path, ExportedSurface surface) {
  geometry::Attributes& attributes =
      surface.points ? surface.points->attributes : surface.file.vertex_attributes;
  const bool is_ply = path.extension() == ".ply";
  if (is_ply) attributes = geometry::with_viewer_names(std::move(attributes));
  if (surface.points)
    geometry::write_point_cloud(path, *surface.points);
  else
    geometry::write_mesh_file(path, surface.file);
  return is_ply || path.extension() == ".vtk" ? surface.words : "";
}

}  // namespace palpate::apps
