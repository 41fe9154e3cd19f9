// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "surfaces/describe_mesh.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <cmath>
#include <variant>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/geometry/cloud_distance.h"
#include "palpate/geometry/curvature.h"
#include "palpate/geometry/error_statistics.h"
#include "palpate/geometry/mesh_measures.h"
#include "palpate/geometry/mesh_topology.h"
#include "palpate/geometry/point_file.h"
#include "palpate/geometry/self_intersections.h"
#include "shared/command_line.h"
#include "shared/words.h"
#include "surfaces/describe_cloud.h"

namespace palpate::apps {
namespace {

std::vector<std::string> names_of(const geometry::Attributes& attributes) {
  std::vector<std::string> names;
  for (const geometry::Attribute& attribute : attributes) names.push_back(attribute.name);
  return names;
}

std::string attributes_in_words(const char* what, const geometry::Attributes& attributes) {
  return attributes.empty()
             ? std::string()
             : fmt::format("; {} attributes: {}", what, fmt::join(names_of(attributes), " "));
}

const char* name_of(geometry::UnitSource source) {
  switch (source) {
    case geometry::UnitSource::stated:
      return "stated";
    case geometry::UnitSource::declared:
      return "declared";
    case geometry::UnitSource::assumed:
      break;
  }
  return "assumed";
}

std::string unit_in_words(const geometry::FileUnit& unit) {
  if (unit.source == geometry::UnitSource::assumed)
    return "; the file declares no unit, so mm is assumed (change with --unit)";
  return fmt::format("; {} units of {} mm",
                     unit.source == geometry::UnitSource::stated ? "read in" : "the file declares",
                     unit.length);
}

/// An area or a volume: with one decimal, or with four digits if that would be fewer, or too long.
std::string quantity(double value) {
  const bool usual = std::abs(value) >= 100 && std::abs(value) < 1e15;
  return usual ? fmt::format("{:.1f}", value) : fmt::format("{:.4g}", value);
}

/// How much the surface bends, where that is known: the larger principal curvature of its vertices.
Description describe_curvature(const geometry::TriangleMesh& mesh) {
  const geometry::VertexCurvature curvature = geometry::vertex_curvature(mesh);
  const Eigen::ArrayXd mean = curvature.mean.array().abs();
  const Eigen::ArrayXd largest =
      mean + (mean.square() - curvature.gaussian.array()).max(0).sqrt();  // [1/mm]
  const geometry::ErrorStatistics bend =
      geometry::error_statistics({largest.begin(), largest.end()});
  if (bend.count == 0) return {{{"curvature", nullptr}}, ""};
  return {{{"curvature", {{"median", bend.median}, {"p95", bend.p95}}}},
          fmt::format("; curvature {:.3g} /mm in the median, at most {:.3g} /mm at 95 % of the "
                      "vertices",
                      bend.median, bend.p95)};
}

/// Area, volume, curvature and topology of a mesh, or why they are undefined.
Description describe_surface(const geometry::TriangleMesh& mesh) {
  try {
    const double area = geometry::surface_area(mesh);
    const std::size_t loops = geometry::boundary_loops(mesh).size();
    const int components = geometry::connected_components(mesh).count;
    const int euler = geometry::euler_characteristic(mesh);
    Description surface = {
        {{"area", area},
         {"volume", nullptr},
         {"components", components},
         {"boundary_loops", loops},
         {"euler_characteristic", euler}},
        fmt::format("area {} mm^2, {}, {}, Euler characteristic {}", quantity(area),
                    counted(components, "component"), counted(loops, "boundary loop"), euler)};
    const auto repeated = (geometry::neighbour_distances(mesh.vertices).array() == 0).count();
    surface.figures["repeated"] = repeated;
    if (repeated > 0) {
      surface.prose += fmt::format(
          "; {} vertices are where another one is, too, so triangles that meet there may be apart "
          "(palpate mesh --repair joins them)",
          repeated);
    }
    if (loops == 0) {
      const double volume = geometry::enclosed_volume(mesh);
      surface.figures["volume"] = volume;
      surface.prose += fmt::format(", volume {} mm^3", quantity(volume));
      if (volume < 0) surface.prose += ", as the triangles face inwards";
    }
    const Description curvature = describe_curvature(mesh);
    surface.figures.update(curvature.figures);
    surface.prose += curvature.prose;
    return surface;
  } catch (const InvalidInput& refused) {
    return {
        {{"not_a_surface", refused.what()}},
        fmt::format("no area or topology, because the mesh is not a surface: {}", refused.what())};
  }
}

/// Lengths of edges and angles of triangles; nothing if the mesh has bad corners.
Description describe_triangles(const geometry::TriangleMesh& mesh) {
  try {
    const geometry::MeshShape shape = geometry::mesh_shape(mesh);
    return {
        {{"edges", shape.edges},
         {"edge_lengths",
          {{"min", shape.shortest_edge},
           {"median", shape.median_edge},
           {"mean", shape.mean_edge},
           {"max", shape.longest_edge}}},
         {"angles",
          {{"min", shape.smallest_angle},
           {"median_min", shape.median_smallest_angle},
           {"max", shape.largest_angle}}}},
        fmt::format("{} edges of {:.4g} to {:.4g} mm, {:.4g} mm in the median; angles of {:.2g} "
                    "to {:.4g} degrees\n",
                    shape.edges, shape.shortest_edge, shape.longest_edge, shape.median_edge,
                    shape.smallest_angle / kDegree, shape.largest_angle / kDegree)};
  } catch (const InvalidInput&) {
    return {Json::object(), ""};  // the defects below tell why
  }
}

/// Lists the defects, and how to repair them.
Description describe_defects(const geometry::TriangleMesh& mesh) {
  Json figures = Json::object();
  std::string prose;
  for (const geometry::MeshDefect& defect : geometry::find_all_defects(mesh)) {
    figures[geometry::to_string(defect.kind)] = defect.elements.size();
    prose += "\n  " + geometry::describe(defect);
  }
  return {{{"defects", figures}},
          prose.empty() ? "no defects"
                        : "defects (counted from 0; palpate mesh --repair repairs all that can be "
                          "repaired; needles and intersections stay):" +
                              prose};
}

/// Bounding box of the finite vertices; empty if there are none.
Eigen::AlignedBox3d extent(const geometry::TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const auto& vertex : mesh.vertices.colwise()) {
    if (vertex.allFinite()) box.extend(vertex);
  }
  return box;
}

Description describe_points(const fs::path& path, const geometry::PointCloud& cloud) {
  check_coordinates(path, cloud);
  const Description points = describe_cloud(cloud);
  Description result = {{{"kind", "points"},
                         {"unit", cloud.unit.length},
                         {"unit_source", name_of(cloud.unit.source)}},
                        "point cloud, " + points.prose + unit_in_words(cloud.unit)};
  result.figures.update(points.figures);
  return result;
}

}  // namespace

Description describe_mesh(const fs::path& path, geometry::ReadOptions options) {
  options.keep_defects = true;
  const auto content = geometry::read_mesh_or_points(path, options);
  if (const auto* cloud = std::get_if<geometry::PointCloud>(&content))
    return describe_points(path, *cloud);
  const auto& file = std::get<geometry::MeshFile>(content);
  const geometry::TriangleMesh& mesh = file.mesh;
  const Eigen::AlignedBox3d box = extent(mesh);
  const Eigen::Vector3d& low = box.min();
  const Eigen::Vector3d& high = box.max();
  const Description defects = describe_defects(mesh);
  const Description surface = describe_surface(mesh);
  const Description triangles = describe_triangles(mesh);
  Description result = {{{"kind", "mesh"},
                         {"vertices", mesh.vertices.cols()},
                         {"triangles", mesh.triangles.cols()},
                         {"min", {low.x(), low.y(), low.z()}},
                         {"max", {high.x(), high.y(), high.z()}},
                         {"unit", file.unit.length},
                         {"unit_source", name_of(file.unit.source)},
                         {"vertex_attributes", names_of(file.vertex_attributes)},
                         {"triangle_attributes", names_of(file.triangle_attributes)}},
                        fmt::format("mesh, {} vertices, {} triangles; {}", mesh.vertices.cols(),
                                    mesh.triangles.cols(), in_words(box)) +
                            unit_in_words(file.unit) +
                            attributes_in_words("vertex", file.vertex_attributes) +
                            attributes_in_words("triangle", file.triangle_attributes) + "\n" +
                            surface.prose + "\n" + triangles.prose + defects.prose};
  result.figures.update(surface.figures);
  result.figures.update(triangles.figures);
  result.figures.update(defects.figures);
  return result;
}

}  // namespace palpate::apps
