// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/self_intersection_removal.h"

// No envelope is requested. CGAL's warnings would go to stderr; failures are thrown as exceptions.
#define CGAL_PMP_REMOVE_SELF_INTERSECTION_NO_POLYHEDRAL_ENVELOPE_CHECK
#define CGAL_NO_WARNINGS
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/repair_self_intersections.h>

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/geometry/cgal_mesh.h"
#include "palpate/geometry/mesh_defects.h"
#include "palpate/geometry/mesh_repair.h"
#include "palpate/geometry/self_intersections.h"

namespace palpate::geometry {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
using Surface = CGAL::Surface_mesh<Point>;

/// The callbacks of CGAL, which copies this.
struct Visitor : pmp::experimental::Remove_self_intersection_default_visitor<Surface> {
  const SelfIntersectionRemovalOptions* options = nullptr;
  int found = 0;
  int* done = nullptr;

  template <class Faces>
  void status_update(const Faces& intersecting) {
    *done = std::max(*done, found - static_cast<int>(intersecting.size()));
  }
  void start_component_handling() {
    if (options->progress) options->progress(*done, found);
  }
};

/// Returns true if the triangles form an oriented manifold. CGAL promises it, but is experimental.
bool is_manifold(const TriangleMesh& mesh) {
  const std::vector<MeshDefect> defects = find_defects(mesh);
  return std::none_of(defects.begin(), defects.end(), [](const MeshDefect& defect) {
    return defect.kind == DefectKind::triangle_repeated ||
           defect.kind == DefectKind::triangle_turned || defect.kind == DefectKind::edge_overfull ||
           defect.kind == DefectKind::vertex_pinched;
  });
}

}  // namespace

SelfIntersectionRemoval remove_self_intersections(const TriangleMesh& mesh,
                                                  const SelfIntersectionRemovalOptions& options) {
  Surface surface = to_surface_mesh<Point>(mesh);
  SelfIntersectionRemoval result{.mesh = mesh, .source = {}, .found = 0, .left = 0};
  result.source.resize(static_cast<std::size_t>(mesh.vertices.cols()));
  std::iota(result.source.begin(), result.source.end(), 0);
  result.found = static_cast<int>(intersecting_triangles(mesh).size());
  if (result.found == 0) return result;

  auto source = surface.add_property_map<Surface::Vertex_index, int>("source", -1).first;
  for (const auto vertex : surface.vertices()) source[vertex] = static_cast<int>(vertex.idx());
  int done = 0;
  Visitor visitor;
  visitor.options = &options;
  visitor.found = result.found;
  visitor.done = &done;
  const std::string failure = "the self-intersections of the mesh could not be removed: ";
  try {
    // Only defects of neighbours, or CGAL would also join surfaces that pass through each other.
    pmp::experimental::remove_self_intersections(
        surface, CGAL::parameters::apply_per_connected_component(false).visitor(visitor));
  } catch (const CGAL::Failure_exception& exception) {
    throw SolverError(failure + exception.what());
  }
  const TriangleMesh removed = from_surface_mesh(surface);
  if (!is_manifold(removed)) throw SolverError(failure + "CGAL's result is not manifold");
  std::vector<int> source_of;
  for (const auto vertex : surface.vertices()) source_of.push_back(source[vertex]);
  // Some patches have triangles without area.
  RepairedMesh repaired = repair_mesh(removed);
  result.mesh = std::move(repaired.mesh);
  result.source.clear();
  for (const int vertex : repaired.source)
    result.source.push_back(source_of[static_cast<std::size_t>(vertex)]);
  result.left = static_cast<int>(intersecting_triangles(result.mesh).size());
  if (options.progress) options.progress(result.found, result.found);
  return result;
}

}  // namespace palpate::geometry
