// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "surfaces/describe_mesh.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
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
#include "surfaces/cloud_steps.h"

namespace palpate::apps {
namespace {

/// "1.5", or "1e+30" for very large numbers.
std::string coordinate(double value, int decimals) {
  constexpr double kLongest = 1e15;  // [mm] doubles hold no more digits
  return std::abs(value) < kLongest ? fmt::format("{:.{}f}", value, decimals)
                                    : fmt::format("{:.6g}", value);
}

/// "X 0.0 to 10.0, Y -3.5 to 2.0, Z 500.0 to 510.0 mm": with enough decimals to give the diagonal
/// three digits, at least one.
std::string in_words(const Eigen::AlignedBox3d& box) {
  constexpr int kDigits = 3;
  constexpr int kMost = 12;
  const double exponent = std::floor(std::log10(box.diagonal().stableNorm()));
  const int decimals = static_cast<int>(std::clamp(kDigits - 1 - exponent, 1.0, 1.0 * kMost));
  const auto range = [&](int axis) {
    return coordinate(box.min()[axis], decimals) + " to " + coordinate(box.max()[axis], decimals);
  };
  return "X " + range(0) + ", Y " + range(1) + ", Z " + range(2) + " mm";
}

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

/// The curvature of the surface: the larger principal curvature of the vertices where it is known.
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

/// Area, volume, curvature and topology of a mesh, or the reason why they are undefined.
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
    return {Json::object(), ""};  // the defects below show the reason
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

/// Bounding box of the finite points; empty if there are none.
Eigen::AlignedBox3d extent(const Eigen::Matrix3Xd& points) {
  Eigen::AlignedBox3d box;
  for (const auto& point : points.colwise()) {
    if (point.allFinite()) box.extend(point);
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

Json corner(const Eigen::Vector3d& corner) {
  return corner.allFinite() ? numbers_in(corner) : Json(nullptr);
}

/// The bounding box of the points, and the distances of points from their nearest neighbours.
std::string place_in_words(const Eigen::AlignedBox3d& box,
                           const geometry::ErrorStatistics& nearest) {
  if (box.isEmpty()) return "";
  std::string prose = "; " + in_words(box);
  if (nearest.count > 0)
    prose += fmt::format("; the nearest other point is {:.4g} mm away (median; 90 %: {:.4g} mm)",
                         nearest.median, nearest.p90);
  return prose;
}

std::string attributes_in_words(const geometry::Attributes& attributes,
                                const std::vector<std::string>& names) {
  if (names.empty()) return "";
  std::string prose = fmt::format("; point attributes: {}", fmt::join(names, " "));
  if (geometry::normals(attributes)) prose += "; with normals";
  if (geometry::colors(attributes)) prose += "; with colours";
  return prose;
}

}  // namespace

Description describe_mesh(const fs::path& path, geometry::ReadOptions options) {
  options.keep_defects = true;
  const auto content = geometry::read_mesh_or_points(path, options);
  if (const auto* cloud = std::get_if<geometry::PointCloud>(&content))
    return describe_points(path, *cloud);
  const auto& file = std::get<geometry::MeshFile>(content);
  const geometry::TriangleMesh& mesh = file.mesh;
  const Eigen::AlignedBox3d box = extent(mesh.vertices);
  const Description defects = describe_defects(mesh);
  const Description surface = describe_surface(mesh);
  const Description triangles = describe_triangles(mesh);
  Description result = {{{"kind", "mesh"},
                         {"vertices", mesh.vertices.cols()},
                         {"triangles", mesh.triangles.cols()},
                         {"min", numbers_in(box.min())},
                         {"max", numbers_in(box.max())},
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

void check_coordinates(const fs::path& path, const geometry::PointCloud& cloud) {
  constexpr double kLargest = 1e100;  // [mm] of cloud_distance.h and the others
  for (Eigen::Index i = 0; i < cloud.points.cols(); ++i) {
    if (cloud.points.col(i).allFinite() && cloud.points.col(i).cwiseAbs().maxCoeff() > kLargest)
      throw InvalidInput(fmt::format(
          "{}: point {} has a coordinate beyond 1e100 mm; correct it, or state the unit (--unit)",
          path.string(), i));
  }
}

Description describe_cloud(const geometry::PointCloud& cloud) {
  const Eigen::AlignedBox3d box = extent(cloud.points);
  const Eigen::Index known = known_count(cloud);
  const Eigen::VectorXd distances = geometry::neighbour_distances(cloud.points);
  const geometry::ErrorStatistics nearest =
      geometry::error_statistics({distances.begin(), distances.end()});
  const auto repeated = (distances.array() == 0).count();
  const std::vector<std::string> names = names_of(cloud.attributes);
  std::string prose = fmt::format("{} x {} points{}, {} of them known", cloud.width, cloud.height,
                                  cloud.height > 1 ? " (organised)" : "", known) +
                      place_in_words(box, nearest) + attributes_in_words(cloud.attributes, names);
  if (repeated > 0) prose += fmt::format("; {} points are where another one is, too", repeated);
  return {{{"points", cloud.points.cols()},
           {"known", known},
           {"width", cloud.width},
           {"height", cloud.height},
           {"min", corner(box.min())},
           {"max", corner(box.max())},
           {"nearest", {{"median", nearest.median}, {"p90", nearest.p90}, {"max", nearest.max}}},
           {"repeated", repeated},
           {"attributes", names}},
          prose};
}

}  // namespace palpate::apps
