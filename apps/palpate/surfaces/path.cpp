// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/file_names.h"
#include "palpate/core/output_file.h"
#include "palpate/geometry/geodesic_path.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/geometry/triangle_mesh.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/output_checks.h"

namespace palpate::apps {
namespace {

using geometry::GeodesicPath;
using geometry::SurfacePoint;
using geometry::TriangleMesh;

struct PathCall {
  fs::path surface, output;
  std::string from;
  std::vector<std::string> to, via;
  geometry::ReadOptions meshes;
};

/// Moves given places onto the surface.
class Places {
 public:
  explicit Places(const TriangleMesh& mesh) : query_(mesh) {}

  SurfacePoint at(const std::string& text) {
    const std::vector<double> place = *numbers_of(text);
    const geometry::ClosestPoint closest =
        query_.closest_point(Eigen::Vector3d(place[0], place[1], place[2]));
    if (closest.at.triangle < 0)
      throw InvalidInput(text + ": is too far away to tell its nearest point on the surface.");
    moved_ = std::max(moved_, closest.distance);
    return closest.at;
  }

  [[nodiscard]] double moved() const { return moved_; }

 private:
  geometry::SurfaceQuery query_;
  double moved_ = 0;
};

/// The path through some places, then straightened between its ends.
std::optional<GeodesicPath> path_via(const geometry::GeodesicSurface& surface,
                                     const std::vector<SurfacePoint>& places) {
  std::vector<SurfacePoint> way = {places.front()};
  for (std::size_t i = 1; i < places.size(); ++i) {
    const auto part =
        geometry::shortest_paths(surface, std::span(&places[i - 1], 1), std::span(&places[i], 1));
    if (!part.front()) return std::nullopt;
    way.insert(way.end(), part.front()->points.begin(), part.front()->points.end());
  }
  return geometry::straighten_path(surface, way);
}

void write_paths(const fs::path& output, const TriangleMesh& mesh,
                 const std::vector<std::optional<GeodesicPath>>& paths) {
  write_file(output, [&](std::ostream& file) {
    file << "path,x,y,z,triangle,b0,b1,b2\n";
    for (std::size_t i = 0; i < paths.size(); ++i) {
      if (!paths[i]) continue;
      for (const SurfacePoint& point : paths[i]->points) {
        const Eigen::Vector3d at = position(mesh, point);
        fmt::print(file, "{},{},{},{},{},{},{},{}\n", i, at.x(), at.y(), at.z(), point.triangle,
                   point.barycentric[0], point.barycentric[1], point.barycentric[2]);
      }
    }
  });
}

/// \throws InvalidInput naming a triangle that no path can cross.
void check_triangles(const TriangleMesh& mesh, const fs::path& file) {
  const Eigen::Matrix3Xd normals = geometry::triangle_normals(mesh);
  for (Eigen::Index t = 0; t < normals.cols(); ++t) {
    if (normals.col(t).allFinite()) continue;
    throw InvalidInput(fmt::format(
        "{0}: triangle {1} has no area, so that no path can cross it. Repair the mesh: palpate "
        "mesh {0} --repair -o repaired.ply",
        file.string(), t));
  }
}

void path(const Settings& settings, const PathCall& call) {
  check_outputs({call.surface}, {call.output});
  if (lower_extension(call.output) != ".csv")
    throw InvalidInput(call.output.string() + ": paths are written as CSV; end the name in .csv.");
  if (!call.via.empty() && call.to.size() != 1)
    throw InvalidInput("palpate path: --via leads one path; pass one --to.");
  const TriangleMesh mesh = geometry::read_mesh(call.surface, call.meshes);
  check_triangles(mesh, call.surface);
  Places places(mesh);
  const SurfacePoint from = places.at(call.from);
  std::vector<SurfacePoint> stops = {from}, targets;
  for (const std::string& via : call.via) stops.push_back(places.at(via));
  for (const std::string& to : call.to) targets.push_back(places.at(to));
  std::vector<std::optional<GeodesicPath>> paths;
  if (call.via.empty()) {
    paths = geometry::shortest_paths(mesh, std::span(&from, 1), targets);
  } else {
    stops.push_back(targets.front());
    paths.push_back(path_via(mesh, stops));
  }
  const auto missing = std::count(paths.begin(), paths.end(), std::nullopt);
  if (missing == static_cast<std::ptrdiff_t>(paths.size())) {
    throw Error(call.surface.string() +
                ": there is no path; the points are on parts of the surface that are not connected "
                "(palpate info tells how many there are).");
  }
  write_paths(call.output, mesh, paths);
  Json figures = {
      {"paths", Json::array()}, {"moved", places.moved()}, {"file", call.output.string()}};
  std::string prose;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const Eigen::Vector3d at = position(mesh, targets[i]);
    const std::size_t count = paths[i] ? paths[i]->points.size() : 0;
    const std::string place = fmt::format("{:.3f}, {:.3f}, {:.3f}", at.x(), at.y(), at.z());
    figures["paths"].push_back(
        {{"to", numbers_in(at)},
         {"length", number_or_null(paths[i] ? std::optional(paths[i]->length) : std::nullopt)},
         {"points", count}});
    prose += paths[i] ? fmt::format("to {}: {:.6g} mm, {} points\n", place, paths[i]->length, count)
                      : fmt::format(
                            "to {}: no path, this part of the surface is not connected "
                            "with the start\n",
                            place);
  }
  prose += fmt::format("The points given were at most {:.3g} mm from the surface. Written to {}",
                       places.moved(), call.output.string());
  print(settings, figures, prose);
  if (missing > 0)
    throw Error(fmt::format("{} of {} paths do not exist; the others were written.", missing,
                            paths.size()));
}

}  // namespace

void add_path(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<PathCall>();
  CLI::App* command =
      app.add_subcommand("path", "Find the shortest paths along a surface between points");
  const CLI::Validator place = list_of_numbers(
      [](const std::vector<double>& numbers) { return numbers.size() == 3; }, "a point X,Y,Z [mm]");
  add_required(*command, "SURFACE", call->surface, "Mesh file");
  command->add_option("--from", call->from, "Place X,Y,Z at which the paths begin [mm]")
      ->required()
      ->check(place);
  command->add_option("--to", call->to, "Place X,Y,Z at which a path ends [mm]; may be repeated")
      ->required()
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->check(place);
  command
      ->add_option("--via", call->via,
                   "Place X,Y,Z [mm]: on which side of holes and handles the path goes; may be "
                   "repeated, in order. The path is pulled tight like a string that was laid "
                   "through these points")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->check(place);
  add_required(*command, "-o,--output", call->output, "Points of the paths to write (CSV)");
  add_unit_option(*command, call->meshes);
  command->footer(
      "Places beside the surface are moved to their closest point on it. The paths are exact on "
      "the\n"
      "triangles (Mitchell, Mount and Papadimitriou 1987). With --via the path is the shortest of\n"
      "those that can be deformed into the one given, which is in general not the shortest of "
      "all.\n"
      "Columns of the file: path (number of the --to, from 0), x, y, z [mm], triangle, and the\n"
      "barycentric coordinates b0, b1, b2 in it.\n"
      "Examples:\n  palpate path surface.ply --from 10,0,500 --to 40,25,510 -o path.csv\n"
      "  palpate path ring.ply --from 20,0,0 --via 0,20,0 --via -20,0,0 --via 0,-20,0 --to 20,0,0 "
      "-o round.csv");
  command->callback([call, &settings] { path(settings, *call); });
}

}  // namespace palpate::apps
