// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/contact_plan.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <string_view>
#include <utility>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/parallel_for.h"
#include "palpate/core/require.h"
#include "palpate/geometry/farthest_points.h"
#include "palpate/geometry/geodesic_distance.h"
#include "palpate/geometry/mesh_measures.h"
#include "palpate/geometry/mesh_topology.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/probing/measurable.h"
#include "records/record_hash.h"

namespace palpate::probing {
namespace {

using geometry::TriangleMesh;

/// A ball touches another place if it contains a point deeper than this part of its radius: above
/// the noise of scans at usual radii.
constexpr double kObstruction = 0.1;
constexpr int kEligibilities = 6;
constexpr std::array<std::string_view, 2> kPatterns{"farthest_point", "grid"};
constexpr int kAnyNumber = std::numeric_limits<int>::max();
/// Most places that a plan looks at: an arm would take years for them.
constexpr double kMostPlaces = 1e5;
constexpr double kGoldenAngle = 2 * std::numbers::pi * (2 - std::numbers::phi);  // [rad]

/// The given highest force, or by default the maximum times 2.6 / 3.
double highest_force(const PlanOptions& options) {
  return options.highest_force.value_or(2.6 * (options.max_force / PlanOptions{}.max_force));
}

void check_options(const PlanOptions& options) {
  static_cast<void>(in_range(options));
  const double highest = highest_force(options);
  require("PlanOptions::lowest_force", options.lowest_force, above(0).at_most(highest), "N");
  require("PlanOptions::max_force", options.max_force,
          at_least(highest).at_most(kLargestMeasurement), "N");
  for (const double place : options.sensor) require("PlanOptions::sensor", place, finite(), "mm");
}

/// Distance of the lines of a grid: all neighbours on it are equally far apart.
double line_distance(double spacing) { return spacing * std::sqrt(3) / 2; }

double in_three_digits(double value) {
  const double scale = std::pow(10, 2 - std::floor(std::log10(value)));
  return std::round(value * scale) / scale;
}

/// Refuses options that make no sense on a surface of this size.
void check_size(const TriangleMesh& mesh, const PlanOptions& options) {
  const double diagonal = geometry::bounding_diagonal(mesh);
  if (diagonal == 0) return;  // no place may be probed
  require("PlanOptions::tip_radius", options.tip_radius,
          above(0).at_most(in_three_digits(diagonal)), "mm");
  const Eigen::Vector3d sides = geometry::bounding_box(mesh).sizes();
  const bool is_grid = options.pattern == PlanPattern::grid;
  // Contacts in farthest-point order are vertices, of which there are no more than that.
  const double most = std::min<double>(options.contacts.value_or(kAnyNumber),
                                       static_cast<double>(mesh.vertices.cols()));
  if (!is_grid && most <= kMostPlaces) return;
  // A surface that the sensor sees edge-on has lines of the grid as well.
  const double longest = std::max(sides.x(), sides.y());
  const double area = is_grid ? std::max(sides.x() * sides.y(), longest * longest / kMostPlaces)
                              : geometry::surface_area(mesh);
  if (area == 0) return;
  const Interval enough =
      at_least(in_three_digits(std::sqrt(area / (kMostPlaces * line_distance(1))))).finite();
  if (enough.contains(options.spacing)) return;
  throw InvalidInput(
      std::vector<MessagePart>{{"PlanOptions::spacing", true},
                               {" " + refusal(options.spacing, enough, "mm") +
                                " on this surface: a plan has at most 100000 places"}});
}

/// The vertices that share an edge with each vertex.
struct Neighbours {
  std::vector<int> first;  // V + 1
  std::vector<int> vertex;

  explicit Neighbours(const TriangleMesh& mesh)
      : first(static_cast<std::size_t>(mesh.vertices.cols()) + 1) {
    for (const int v : mesh.triangles.reshaped()) first[static_cast<std::size_t>(v) + 1] += 2;
    for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
    vertex.resize(static_cast<std::size_t>(first.back()));
    std::vector<int> next(first.begin(), first.end() - 1);
    for (const auto& corners : mesh.triangles.colwise()) {
      for (int k = 0; k < 3; ++k) {
        int& place = next[static_cast<std::size_t>(corners[k])];
        vertex[static_cast<std::size_t>(place++)] = corners[(k + 1) % 3];
        vertex[static_cast<std::size_t>(place++)] = corners[(k + 2) % 3];
      }
    }
  }
};

/// For each vertex, the direction of the sum of the area vectors of the triangles at the vertices
/// within `radius` of it that are connected with it inside that ball.
Eigen::Matrix3Xd fitted_normals(const TriangleMesh& mesh, double radius) {
  Eigen::Matrix3Xd areas = Eigen::Matrix3Xd::Zero(3, mesh.vertices.cols());
  for (const auto& corners : mesh.triangles.colwise()) {
    const Eigen::Vector3d a = mesh.vertices.col(corners[0]);
    const Eigen::Vector3d area =
        (mesh.vertices.col(corners[1]) - a).cross(mesh.vertices.col(corners[2]) - a);
    for (const int corner : corners) areas.col(corner) += area;
  }
  const Neighbours neighbours(mesh);
  Eigen::Matrix3Xd normals(3, mesh.vertices.cols());
  constexpr std::ptrdiff_t kGrain = 2000;
  parallel_ranges(mesh.vertices.cols(), kGrain, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    std::vector<Eigen::Index> found_from(static_cast<std::size_t>(mesh.vertices.cols()), -1);
    std::vector<int> found;
    for (Eigen::Index v = begin; v < end; ++v) {
      found.assign(1, static_cast<int>(v));
      found_from[static_cast<std::size_t>(v)] = v;
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (std::size_t i = 0; i < found.size(); ++i) {
        sum += areas.col(found[i]);
        const auto at = static_cast<std::size_t>(found[i]);
        for (int n = neighbours.first[at]; n < neighbours.first[at + 1]; ++n) {
          const int other = neighbours.vertex[static_cast<std::size_t>(n)];
          Eigen::Index& seen = found_from[static_cast<std::size_t>(other)];
          if (seen == v) continue;
          seen = v;
          const double squared = (mesh.vertices.col(other) - mesh.vertices.col(v)).squaredNorm();
          if (squared <= radius * radius) found.push_back(other);
        }
      }
      normals.col(v) = sum / sum.norm();  // NaN without triangles
    }
  });
  return normals;
}

std::vector<bool> near_border(const TriangleMesh& mesh, double distance) {
  std::vector<bool> near(static_cast<std::size_t>(mesh.vertices.cols()));
  const std::vector<geometry::SurfacePoint> places = geometry::vertex_points(mesh);
  std::vector<geometry::SurfacePoint> border;
  for (const std::vector<int>& loop : geometry::boundary_loops(mesh)) {
    for (const int v : loop) border.push_back(places[static_cast<std::size_t>(v)]);
  }
  if (border.empty() || distance == 0) return near;
  const Eigen::VectorXd from_border =
      geometry::geodesic_distance(mesh, border, {.stop_radius = distance}).distance;
  for (std::size_t v = 0; v < near.size(); ++v)
    near[v] = from_border[static_cast<Eigen::Index>(v)] < distance;
  return near;
}

/// [mm] Largest distance of a candidate from the nearest contact.
double cover_of(const TriangleMesh& mesh, std::span<const int> vertices,
                std::span<const int> candidates) {
  const std::vector<geometry::SurfacePoint> places = geometry::vertex_points(mesh);
  std::vector<geometry::SurfacePoint> sources;
  for (const int v : vertices) sources.push_back(places[static_cast<std::size_t>(v)]);
  const Eigen::VectorXd distance = geometry::geodesic_distance(mesh, sources).distance;
  double cover = 0;
  for (const int v : candidates) cover = std::max(cover, distance[v]);
  return cover;
}

/// Vertices on alternating grid lines, seen along the sensor's axis Z (thesis 4.2).
std::vector<int> grid_vertices(const TriangleMesh& mesh, std::span<const Eligibility> eligible,
                               const PlanOptions& options) {
  const geometry::SurfaceQuery query(mesh);
  const Eigen::AlignedBox3d box = geometry::bounding_box(mesh);
  const Eigen::Vector3d low = box.min(), high = box.max();
  const double depth = high.z() - low.z() + options.spacing;
  std::vector<int> found;
  std::vector<bool> is_found(eligible.size());
  bool shifted = false;
  const double line = line_distance(options.spacing);
  for (double y = low.y() + line / 2; y < high.y(); y += line, shifted = !shifted) {
    for (double x = low.x() + options.spacing * (shifted ? 1 : 0.5); x < high.x();
         x += options.spacing) {
      const auto hit = query.first_hit({.origin = {x, y, low.z() - options.spacing},
                                        .direction = Eigen::Vector3d::UnitZ(),
                                        .max_distance = 2 * depth});
      if (!hit) continue;
      int corner = 0;
      hit->at.barycentric.maxCoeff(&corner);
      const int v = mesh.triangles(corner, hit->at.triangle);
      if (eligible[static_cast<std::size_t>(v)] != Eligibility::eligible) continue;
      if (is_found[static_cast<std::size_t>(v)]) continue;
      is_found[static_cast<std::size_t>(v)] = true;
      found.push_back(v);
      if (static_cast<int>(found.size()) >= options.contacts.value_or(kAnyNumber)) return found;
    }
  }
  return found;
}

std::string counts(std::span<const Eigen::Index> excluded) {
  std::string text;
  for (int i = 1; i < kEligibilities; ++i) {
    const Eigen::Index count = excluded[static_cast<std::size_t>(i)];
    if (count == 0) continue;
    text += (text.empty() ? "" : ", ") + std::to_string(count) + " " +
            to_string(static_cast<Eligibility>(i));
  }
  return text;
}

}  // namespace

const char* to_string(PlanPattern pattern) {
  return kPatterns[static_cast<std::size_t>(pattern)].data();
}

const char* to_string(Eligibility eligibility) {
  switch (eligibility) {
    case Eligibility::eligible:
      return "eligible";
    case Eligibility::no_surface:
      return "no_surface";
    case Eligibility::near_border:
      return "near_border";
    case Eligibility::oblique:
      return "oblique";
    case Eligibility::obstructed:
      return "obstructed";
    case Eligibility::not_needed:
      return "not_needed";
  }
  return "";
}

double direction_angle(const PlanOptions& options, int level, int k) {
  return kGoldenAngle * level + 2 * std::numbers::pi * k / options.directions;
}

Eigen::Matrix3d tangent_frame(const Contact& contact) {
  const Eigen::Vector3d inward = -contact.normal.normalized();
  Eigen::Vector3d along = Eigen::Vector3d::UnitX() - inward * inward.x();
  constexpr double kAlongNormal = 1e-3;  // sine of the angle
  if (along.norm() < kAlongNormal) along = Eigen::Vector3d::UnitY() - inward * inward.y();
  along.normalize();
  Eigen::Matrix3d frame;
  frame << along, inward.cross(along), inward;
  return frame;
}

std::vector<Eligibility> eligibility(const TriangleMesh& mesh, const PlanOptions& options,
                                     Eigen::Matrix3Xd& normals) {
  check_options(options);
  geometry::check_mesh(mesh, "plan_contacts");
  check_size(mesh, options);
  normals = fitted_normals(mesh, options.tip_radius);
  const std::vector<bool> at_border = near_border(mesh, options.border * options.tip_radius);
  const geometry::SurfaceQuery query(mesh);
  const double least_cosine = std::cos(options.view_angle);
  std::vector<Eligibility> result(static_cast<std::size_t>(mesh.vertices.cols()));
  parallel_for(static_cast<int>(mesh.vertices.cols()), [&](int v) {
    const Eigen::Vector3d at = mesh.vertices.col(v), normal = normals.col(v);
    Eligibility& found = result[static_cast<std::size_t>(v)];
    if (!normal.allFinite()) {
      found = Eligibility::no_surface;
    } else if (at_border[static_cast<std::size_t>(v)]) {
      found = Eligibility::near_border;
    } else if (!(normal.dot((options.sensor - at).normalized()) >= least_cosine)) {
      found = Eligibility::oblique;
    } else if (query.closest_point(at + options.tip_radius * normal).distance <
               (1 - kObstruction) * options.tip_radius) {
      found = Eligibility::obstructed;
    }
  });
  return result;
}

void visit(PlanOptions& options, FieldVisitor& visitor) {
  constexpr double kMostTrials = 1000;  // levels, or directions; no arm tries as many at a contact
  constexpr Interval kForces = above(0).finite();
  visitor.begin("PlanOptions");
  visitor.choice({"pattern",
                  "How contacts are spread: farthest_point, evenly along the surface, each prefix "
                  "is a coarser plan; grid, on alternating lines as the sensor sees them"},
                 options.pattern, kPatterns);
  visitor.real({"spacing", "Smallest distance between contacts", "mm"}, options.spacing,
               above(0).finite());
  visitor.whole({"contacts", "Largest number of contacts. Without it: no limit"}, options.contacts,
                at_least(1));
  visitor.real({"tip_radius", "Radius of the tip, a ball", "mm"}, options.tip_radius,
               above(0).finite());
  visitor.real({"border",
                "Smallest distance of contacts from the border along the surface, in radii of the "
                "tip"},
               options.border, at_least(0).finite());
  visitor.real(
      {"view_angle",
       "Largest angle between the normal at a contact and the direction to the sensor", "rad"},
      options.view_angle, above(0).at_most(std::numbers::pi / 2));
  visitor.real({"lowest_force", "Smallest normal force", "N"}, options.lowest_force, kForces);
  visitor.real({"highest_force",
                "Largest normal force; at least lowest_force. Without it: 87 % of max_force", "N"},
               options.highest_force, kForces);
  visitor.whole({"levels", "Number of normal forces, in geometric progression"}, options.levels,
                at_least(1).at_most(kMostTrials));
  visitor.whole({"directions",
                 "Number of directions of the tangential force under each normal force, turned "
                 "from one to the next"},
                options.directions, at_least(0).at_most(kMostTrials));
  visitor.real({"max_force", "Largest force that the arm applies; at least highest_force", "N"},
               options.max_force, kForces);
}

ContactPlan plan_contacts(const TriangleMesh& mesh, const PlanOptions& given,
                          const std::vector<bool>& needed) {
  check_options(given);
  if (!needed.empty() && needed.size() != static_cast<std::size_t>(mesh.vertices.cols())) {
    throw InvalidInput("plan_contacts: needed has " + std::to_string(needed.size()) +
                       " values; the surface has " + std::to_string(mesh.vertices.cols()) +
                       " vertices");
  }
  PlanOptions options = given;
  options.highest_force = highest_force(given);
  Eigen::Matrix3Xd normals;
  std::vector<Eligibility> eligible = eligibility(mesh, options, normals);
  for (std::size_t v = 0; v < needed.size(); ++v)
    if (!needed[v] && eligible[v] == Eligibility::eligible) eligible[v] = Eligibility::not_needed;
  ContactPlan plan{.options = options};
  plan.excluded.resize(kEligibilities);
  std::vector<int> candidates;
  for (std::size_t v = 0; v < eligible.size(); ++v) {
    ++plan.excluded[static_cast<std::size_t>(eligible[v])];
    if (eligible[v] == Eligibility::eligible) candidates.push_back(static_cast<int>(v));
  }
  std::vector<int> chosen;
  if (options.pattern == PlanPattern::grid) {
    chosen = grid_vertices(mesh, eligible, options);
  } else if (!candidates.empty()) {
    const geometry::FarthestPoints points = geometry::farthest_points(
        mesh, candidates,
        {.spacing = options.spacing, .count = options.contacts.value_or(kAnyNumber)});
    chosen = points.vertices;
    plan.cover = points.cover.back();
  }
  if (chosen.empty()) {
    const bool turned =
        plan.excluded[static_cast<std::size_t>(Eligibility::oblique)] > mesh.vertices.cols() / 2;
    throw InvalidInput("plan_contacts: no point of the surface may be probed: of " +
                       std::to_string(mesh.vertices.cols()) + " vertices " + counts(plan.excluded) +
                       (turned ? ". Are the triangles turned inwards, or the sensor elsewhere?"
                               : ". A smaller tip or spacing would leave more"));
  }
  if (options.pattern == PlanPattern::grid) plan.cover = cover_of(mesh, chosen, candidates);
  for (const int v : chosen) {
    plan.contacts.push_back(
        {static_cast<long long>(plan.contacts.size()), mesh.vertices.col(v), normals.col(v)});
  }
  for (int level = 0; level < options.levels; ++level) {
    const double part = options.levels > 1 ? level / (options.levels - 1.0) : 1;
    plan.normal_forces.push_back(options.lowest_force *
                                 std::pow(*options.highest_force / options.lowest_force, part));
  }
  plan.normal_forces.back() = *options.highest_force;
  plan.surface = surface_fingerprint(mesh);
  return plan;
}

std::string surface_fingerprint(const TriangleMesh& mesh) {
  RecordHash hash(static_cast<std::uint64_t>(mesh.vertices.cols()));
  for (const auto& vertex : mesh.vertices.colwise()) hash.add(Eigen::Vector3d(vertex));
  for (const int corner : mesh.triangles.reshaped()) hash.add(static_cast<std::uint64_t>(corner));
  return hash.digits();
}

}  // namespace palpate::probing
