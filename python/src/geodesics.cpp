// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "palpate/geometry/geodesic_distance.h"
#include "palpate/geometry/geodesic_path.h"
#include "palpate/geometry/surface_query.h"
#include "places.h"

namespace palpate::python {
namespace {

using geometry::GeodesicDistance;
using geometry::GeodesicMethod;
using geometry::GeodesicPath;
using geometry::GeodesicSurface;
using geometry::SurfacePoint;
using geometry::TriangleMesh;

/// \throws InvalidInput if places are on a mesh of another size.
void check_mesh_of(const MeshSize& places, const TriangleMesh& mesh, const std::string& name) {
  const MeshSize size = mesh_size(mesh);
  if (places == size) return;
  const auto words = [](const MeshSize& of) {
    return std::to_string(of.vertices) + " vertices and " + std::to_string(of.triangles) +
           (of.triangles == 1 ? " triangle" : " triangles");
  };
  throw InvalidInput(name + ": lie on another mesh, with " + words(places) + "; this one has " +
                     words(size));
}

/// \throws InvalidInput that tells what else places may be.
std::vector<SurfacePoint> vertices_of(const TriangleMesh& mesh, const py::object& numbers,
                                      const char* name) {
  try {
    const py::array_t<int> vertices = indices(numbers, name, 1);
    return vertex_points(mesh, {vertices.data(), static_cast<std::size_t>(vertices.size())}, name);
  } catch (const InvalidInput& error) {
    throw InvalidInput(
        error.what() +
        std::string(". Vertices are given by their indices, (N,), and coordinates as "
                    "ClosestPoints: SurfaceQuery(mesh).closest_points(coordinates)"));
  }
}

/// Places on a mesh: closest points, or vertices by their indices.
std::vector<SurfacePoint> surface_points(const TriangleMesh& mesh, const py::object& places,
                                         const char* name) {
  if (py::isinstance<PlacesOnMesh>(places)) {
    std::vector<SurfacePoint> points;
    const auto& given = places.cast<const PlacesOnMesh&>();
    check_mesh_of(given.mesh, mesh, name);
    for (Eigen::Index i = 0; i < given.triangles.size(); ++i)
      points.push_back({given.triangles[i], given.barycentric.col(i)});
    return points;
  }
  return vertices_of(mesh, places, name);
}

/// A mesh for one call, or one that is prepared for several.
using GivenSurface = std::variant<const TriangleMesh*, const GeodesicSurface*>;

/// \throws InvalidInput if a mesh is not valid.
GeodesicSurface surface_of(const GivenSurface& given) {
  return std::visit([](const auto* mesh) { return GeodesicSurface(*mesh); }, given);
}

void add_surface(py::module_& module) {
  py::class_<GeodesicSurface>(
      module, "GeodesicSurface",
      R"(A mesh with what distances and paths on it need, for several calls on one mesh.

Pass it in place of the mesh to geodesic_distance, geodesic_distances, shortest_paths and
straighten_path. It has a copy of the mesh. Raises InvalidInput if the mesh is not valid.)")
      .def(py::init<const TriangleMesh&>(), arg("mesh"));
}

GeodesicMethod method_of(const std::string& name) {
  return choose<GeodesicMethod>(
      "method", name,
      {{"fast_marching", GeodesicMethod::fast_marching}, {"exact", GeodesicMethod::exact}});
}

void add_distances(py::module_& module) {
  py::class_<GeodesicDistance>(module, "GeodesicDistance", "The result of geodesic_distance().")
      .def_property_readonly(
          "distance",
          [](const py::object& self) {
            return vector_view(self.cast<GeodesicDistance&>().distance, self);
          },
          "[mm] (V,) to the nearest source; infinity if not reached.")
      .def_property_readonly(
          "label",
          [](const py::object& self) {
            return vector_view(self.cast<GeodesicDistance&>().label, self);
          },
          "(V,) int32 index of the nearest source (its Voronoi cell); -1 if not reached.");
  module.def(
      "geodesic_distance",
      [](const GivenSurface& mesh, const py::object& sources, const std::string& method,
         double stop_radius) {
        const GeodesicSurface surface = surface_of(mesh);
        const geometry::GeodesicOptions options{.method = method_of(method),
                                                .stop_radius = stop_radius};
        const std::vector<SurfacePoint> points = surface_points(surface.mesh(), sources, "sources");
        const Unlocked unlocked;
        return geometry::geodesic_distance(surface, points, options);
      },
      arg("mesh").none(false), arg("sources"), kw_only(), arg("method") = "fast_marching",
      arg("stop_radius") = std::numeric_limits<double>::infinity(),
      R"(Distance along the surface of each vertex to the nearest of several sources.

sources: (N,) indices of vertices, or ClosestPoints of this mesh.
method: 'fast_marching' (errors of some tenths of a percent) or 'exact'.
stop_radius: [mm] largest distance.
Raises InvalidInput. Ctrl-C is not heard.)");
  module.def(
      "geodesic_distances",
      [](const GivenSurface& mesh, const py::object& sources, const std::string& method,
         double stop_radius) {
        const GeodesicSurface surface = surface_of(mesh);
        const std::vector<SurfacePoint> points = surface_points(surface.mesh(), sources, "sources");
        const geometry::GeodesicOptions options{.method = method_of(method),
                                                .stop_radius = stop_radius};
        Eigen::MatrixXd found;
        {
          const Unlocked unlocked;
          found = geometry::geodesic_distances(surface, points, options);
        }
        return py::array_t<double>({found.cols(), found.rows()}, found.data());
      },
      arg("mesh").none(false), arg("sources"), kw_only(), arg("method") = "fast_marching",
      arg("stop_radius") = std::numeric_limits<double>::infinity(),
      R"(Distance along the surface of each vertex to each of several sources, in several threads.

sources, method, stop_radius: as geodesic_distance().
Returns [mm] (N, V), a row for each source; infinity if not reached. Raises InvalidInput. Ctrl-C is
not heard.)");
}

/// The places of a path in arrays.
struct PathArrays {
  Eigen::VectorXi triangles;
  Eigen::Matrix3Xd barycentric, positions;
  double length;
  int source;
  MeshSize mesh;
};

PathArrays arrays_of(const TriangleMesh& mesh, const GeodesicPath& path) {
  const auto count = static_cast<Eigen::Index>(path.points.size());
  PathArrays arrays{.triangles = Eigen::VectorXi(count),
                    .barycentric = Eigen::Matrix3Xd(3, count),
                    .positions = Eigen::Matrix3Xd(3, count),
                    .length = path.length,
                    .source = path.source,
                    .mesh = mesh_size(mesh)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const SurfacePoint& point = path.points[static_cast<std::size_t>(i)];
    arrays.triangles[i] = point.triangle;
    arrays.barycentric.col(i) = point.barycentric;
    arrays.positions.col(i) = position(mesh, point);
  }
  return arrays;
}

void append(std::vector<SurfacePoint>& points, const PathArrays& path, const TriangleMesh& mesh) {
  check_mesh_of(path.mesh, mesh, "path: its points");
  for (Eigen::Index i = 0; i < path.triangles.size(); ++i)
    points.push_back({path.triangles[i], path.barycentric.col(i)});
}

/// One path, several that follow each other, or vertices.
std::vector<SurfacePoint> way_of(const TriangleMesh& mesh, const py::object& way) {
  std::vector<SurfacePoint> points;
  if (py::isinstance<PathArrays>(way)) {
    append(points, way.cast<const PathArrays&>(), mesh);
    return points;
  }
  if (py::isinstance<py::list>(way) || py::isinstance<py::tuple>(way)) {
    for (const py::handle part : way) {
      if (!py::isinstance<PathArrays>(part)) return surface_points(mesh, way, "path");
      append(points, part.cast<const PathArrays&>(), mesh);
    }
    return points;
  }
  return surface_points(mesh, way, "path");
}

void add_paths(py::module_& module) {
  py::class_<PathArrays>(module, "GeodesicPath",
                         "A path of N places on a surface; arrays are views that keep it alive.")
      .def_property_readonly(
          "triangles",
          [](const py::object& self) {
            return vector_view(self.cast<PathArrays&>().triangles, self);
          },
          "(N,) int32; the triangle of a place also has the place before it.")
      .def_property_readonly(
          "barycentric",
          [](const py::object& self) {
            return rows_view(self.cast<PathArrays&>().barycentric, self);
          },
          "(N, 3) in the order of the triangle's vertices.")
      .def_property_readonly(
          "positions",
          [](const py::object& self) {
            return rows_view(self.cast<PathArrays&>().positions, self);
          },
          "[mm] (N, 3).")
      .def_readonly("length", &PathArrays::length, "[mm] along the surface.")
      .def_readonly("source", &PathArrays::source, "Index of the source at which it begins.");
  module.def(
      "shortest_paths",
      [](const GivenSurface& given, const py::object& sources, const py::object& targets) {
        const GeodesicSurface surface = surface_of(given);
        const TriangleMesh& mesh = surface.mesh();
        const std::vector<SurfacePoint> from = surface_points(mesh, sources, "sources");
        const std::vector<SurfacePoint> to = surface_points(mesh, targets, "targets");
        const Unlocked unlocked;
        std::vector<std::optional<PathArrays>> paths;
        for (const std::optional<GeodesicPath>& path :
             geometry::shortest_paths(surface, from, to)) {
          paths.emplace_back();
          if (path) paths.back() = arrays_of(mesh, *path);
        }
        return paths;
      },
      arg("mesh").none(false), arg("sources"), arg("targets"),
      R"(The shortest path along the surface to each target, from the source nearest to it; exact.

sources, targets: (N,) indices of vertices, or ClosestPoints of this mesh.
Returns a list with a GeodesicPath for each target; None where no source is connected with it.
Raises InvalidInput, or SolverError if triangles are too thin. Ctrl-C is not heard.)");
  module.def(
      "straighten_path",
      [](const GivenSurface& mesh, const py::object& path) {
        const GeodesicSurface surface = surface_of(mesh);
        const std::vector<SurfacePoint> way = way_of(surface.mesh(), path);
        const Unlocked unlocked;
        return arrays_of(surface.mesh(), geometry::straighten_path(surface, way));
      },
      arg("mesh").none(false), arg("path"),
      R"(Pulls a path tight between its ends, without leaving the side of holes and handles it is on.

path: a GeodesicPath, a list of several that follow each other, or (N,) indices of vertices that are
neighbours along edges.
Raises InvalidInput naming the place that is in no triangle of the one before it. Ctrl-C is not
heard.)");
}

}  // namespace

void add_geodesics(py::module_& module) {
  add_surface(module);
  add_distances(module);
  add_paths(module);
}

}  // namespace palpate::python
