// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/known_forces.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <mutex>
#include <numbers>
#include <optional>
#include <random>
#include <string>

#include "palpate/core/error.h"
#include "palpate/core/parallel_for.h"
#include "palpate/core/require.h"
#include "palpate/geometry/geodesic_distance.h"
#include "palpate/geometry/mesh_topology.h"
#include "palpate/probing/csv.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

constexpr double kInsideCone = 0.9;  // of the coefficient of friction, the most that is asked for

// The vertices at least `margin` away from the border.
std::vector<bool> inner_vertices(const geometry::TriangleMesh& mesh, double margin) {
  const std::vector<geometry::SurfacePoint> places = geometry::vertex_points(mesh);
  std::vector<geometry::SurfacePoint> border;
  for (const std::vector<int>& loop : geometry::boundary_loops(mesh)) {
    for (const int v : loop) border.push_back(places[static_cast<std::size_t>(v)]);
  }
  std::vector<bool> inner(places.size(), true);
  if (border.empty() || margin == 0) return inner;
  const Eigen::VectorXd distance = geometry::geodesic_distance(mesh, border).distance;
  for (std::size_t v = 0; v < inner.size(); ++v)
    inner[v] = distance[static_cast<Eigen::Index>(v)] >= margin;
  return inner;
}

std::vector<int> inner_triangles(const geometry::TriangleMesh& mesh, double margin) {
  const std::vector<bool> inner = inner_vertices(mesh, margin);
  const auto is_inner = [&](int vertex) { return inner[static_cast<std::size_t>(vertex)]; };
  std::vector<int> triangles;
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    if (is_inner(mesh.triangles(0, t)) && is_inner(mesh.triangles(1, t)) &&
        is_inner(mesh.triangles(2, t)))
      triangles.push_back(t);
  }
  return triangles;
}

// Places and forces, without displacements.
std::vector<KnownForce> draw_forces(const Specimen& specimen, const KnownForceOptions& options) {
  const geometry::TriangleMesh& mesh = specimen.surface();
  const std::vector<int> triangles = inner_triangles(mesh, options.margin);
  if (triangles.empty()) {
    throw InvalidInput(
        std::vector<MessagePart>{{"known_forces()", true},
                                 {": no place is as far from the border of the surface as "},
                                 {"KnownForceOptions::margin", true},
                                 {", " + to_text(options.margin) + " mm; give a smaller one, or "},
                                 {"KnownForceOptions::queries", true},
                                 {" 0"}});
  }
  std::mt19937 random(options.seed);
  std::uniform_int_distribution<std::size_t> any(0, triangles.size() - 1);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<KnownForce> drawn(static_cast<std::size_t>(options.queries));
  for (KnownForce& one : drawn) {
    double u = uniform(random), v = uniform(random);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    one.contact = geometry::position(mesh, {triangles[any(random)], {1 - u - v, u, v}});
    const FrictionCone cone = specimen.friction_cone(one.contact);
    const double angle = 2 * std::numbers::pi * uniform(random);
    const Vector3d x = cone.axis.unitOrthogonal(), y = cone.axis.cross(x);
    const double ratio = kInsideCone * cone.coefficient * std::sqrt(uniform(random));
    const double size =
        options.least_force + (options.max_force - options.least_force) * uniform(random);
    one.force =
        size * (cone.axis + ratio * (std::cos(angle) * x + std::sin(angle) * y)).normalized();
  }
  return drawn;
}

}  // namespace

void visit(KnownForceOptions& options, FieldVisitor& visitor) {
  constexpr int kMostQueries = 100'000;
  visitor.begin("KnownForceOptions");
  visitor.whole({"queries", "Number of known forces between contacts, to compare a model with"},
                options.queries, at_least(0).at_most(kMostQueries));
  visitor.real({"margin", "Smallest distance of their places from the border of the surface", "mm"},
               options.margin, at_least(0).finite());
  visitor.real({"max_force", "Largest of the forces", "N"}, options.max_force, above(0).finite());
  visitor.whole({"seed", "Seed of the random places and forces"}, options.seed, at_least(0));
  visitor.real({"least_force", "Smallest of the forces", "N", true}, options.least_force,
               above(0).finite());
}

KnownForces known_forces(const Specimen& specimen, const KnownForceOptions& options) {
  static_cast<void>(in_range(options));
  require("KnownForceOptions::max_force", options.max_force, at_least(options.least_force).finite(),
          "N");
  if (options.queries == 0) return {};
  const std::vector<KnownForce> drawn = draw_forces(specimen, options);
  std::vector<std::optional<Vector3d>> displacements(drawn.size());
  std::vector<std::string> reasons(drawn.size());
  std::mutex reporting;
  int done = 0;
  parallel_for(drawn.size(), [&](std::size_t i) {
    displacements[i] = response_of(specimen, drawn[i].contact, drawn[i].force, reasons[i]);
    const std::scoped_lock lock(reporting);
    if (options.progress) options.progress(++done, options.queries);
  });
  KnownForces known;
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    if (displacements[i])
      known.forces.push_back({drawn[i].contact, *displacements[i], drawn[i].force});
    else
      known.unanswered.push_back({drawn[i].contact, drawn[i].force, reasons[i]});
  }
  return known;
}

}  // namespace palpate::probing
