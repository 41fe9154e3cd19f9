// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/remeshing.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <queue>
#include <utility>
#include <vector>

#include "base/numbers.h"
#include "mesh/editable_mesh.h"
#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "palpate/geometry/mesh_measures.h"
#include "palpate/geometry/mesh_topology.h"
#include "palpate/geometry/surface_query.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;

/// Edges longer or shorter than these parts of the wanted length are split or collapsed: after
/// either, an edge is nearer to the length than before (Botsch and Kobbelt 2004).
constexpr double kLongest = 4.0 / 3;
constexpr double kShortest = 4.0 / 5;

/// No step turns the normal of a triangle by more than the angle of this cosine.
constexpr double kLeastTurnCosine = 0.5;

/// Edges and angles hardly change after this number of iterations.
constexpr int kIterations = 10;

/// An iteration has at most this number of sweeps that flip edges; the last ones change little.
constexpr int kFlipSweeps = 4;

/// Work between two calls of `progress` within a step, in edges or vertices.
constexpr int kBetweenCalls = 1 << 18;

/// Twice the area times the normal.
Vector3d area_vector(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  return (b - a).cross(c - a);
}

/// Returns true if a triangle with area is turned too far, or loses its area.
bool is_turned(const Vector3d& before, const Vector3d& after) {
  const double product = before.norm() * after.norm();
  return before.squaredNorm() > 0 && !(before.dot(after) > kLeastTurnCosine * product);
}

/// The angle at c in a triangle with corners a, b and c.
double angle_opposite(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  return std::atan2((a - c).cross(b - c).norm(), (a - c).dot(b - c));
}

/// Allowed changes of a vertex.
enum class Freedom : char {
  full,
  on_line,  ///< on a straight part of a feature: moves along it, or is left out
  none
};

class Remesher {
 public:
  Remesher(const TriangleMesh& input, const RemeshingOptions& options)
      : options_(options),
        edge_length_(*options.edge_length),
        query_(input),
        normals_(triangle_normals(input)),
        mesh_(input, "remesh") {
    mark_features();
    freedom_.resize(static_cast<size_t>(mesh_.vertex_count()));
    for (int v = 0; v < mesh_.vertex_count(); ++v) freedom_[static_cast<size_t>(v)] = freedom_at(v);
  }

  Remeshing run() {
    constexpr int kSteps = 4;
    total_ = kSteps * kIterations + 1;
    for (int i = 0; i < kIterations; ++i) {
      split_long_edges();
      advance();
      collapse_short_edges();
      advance();
      flip_edges();
      advance();
      smooth_and_project();
      advance();
    }
    flip_edges();
    Remeshing result{.mesh = mesh_.mesh(), .places = {}};
    const ClosestPoints places = closest_points(query_, result.mesh.vertices);
    for (Eigen::Index v = 0; v < result.mesh.vertices.cols(); ++v)
      result.places.push_back({places.triangles[v], places.barycentric.col(v)});
    advance();
    return result;
  }

 private:
  void advance() {
    ++done_;
    report();
  }
  void report() const {
    if (options_.progress) options_.progress(done_, total_);
  }
  void report_sometimes(int i) const {
    if (i % kBetweenCalls == kBetweenCalls - 1) report();
  }

  [[nodiscard]] Freedom freedom(int v) const { return freedom_[static_cast<size_t>(v)]; }

  void mark_features() {
    const double least_cosine = std::cos(options_.feature_angle);
    for (int h = 0; h < mesh_.half_edge_count(); ++h) {
      const int g = mesh_.opposite(h);
      const bool bends = g >= 0 && options_.feature_angle < std::numbers::pi &&
                         normals_.col(h / 3).dot(normals_.col(g / 3)) < least_cosine;
      if (g < 0 || bends) mesh_.make_feature(h);
    }
  }

  /// The two vertices next to a vertex along a feature, if it is on one and neither at its end nor
  /// where several meet.
  [[nodiscard]] std::vector<int> along_feature(int v) const {
    std::vector<int> found;
    mesh_.each_leaving(v, [&](int h) {
      if (mesh_.is_feature(h)) found.push_back(mesh_.end(h));
      const int last = EditableMesh::last(h);
      if (mesh_.opposite(last) < 0) found.push_back(mesh_.apex(h));
    });
    return found;
  }

  [[nodiscard]] bool is_on_line(int v, int before, int after) const {
    const Vector3d line = mesh_.at(after) - mesh_.at(before);
    const Vector3d to = mesh_.at(v) - mesh_.at(before);
    const double along = to.dot(line);
    return along > 0 && along < line.squaredNorm() &&
           line.cross(to).norm() <= kFeatureTolerance * edge_length_ * line.norm();
  }

  [[nodiscard]] Freedom freedom_at(int v) const {
    const std::vector<int> ends = along_feature(v);
    if (ends.empty()) return Freedom::full;
    return ends.size() == 2 && is_on_line(v, ends[0], ends[1]) ? Freedom::on_line : Freedom::none;
  }

  /// The longest first: a cut is then shorter than the edge, so that the work ends soon.
  void split_long_edges() {
    struct LongEdge {
      double length;
      int half_edge;
      bool operator<(const LongEdge& other) const {
        return std::pair(length, half_edge) < std::pair(other.length, other.half_edge);
      }
    };
    const double longest = kLongest * edge_length_;
    std::vector<LongEdge> edges;
    const auto add = [&](int h) {
      if (const double length = mesh_.length(h); length > longest) edges.push_back({length, h});
    };
    for (int h = 0; h < mesh_.half_edge_count(); ++h)
      if (mesh_.is_live(h) && h > mesh_.opposite(h)) add(h);
    std::priority_queue<LongEdge> queue({}, std::move(edges));
    edges.clear();
    for (int done = 0; !queue.empty(); ++done) {
      report_sometimes(done);
      const LongEdge edge = queue.top();
      queue.pop();
      if (mesh_.length(edge.half_edge) != edge.length) continue;  // has been split
      if (mesh_.triangle_count() >= options_.max_triangles) refuse_size();
      const bool is_feature = mesh_.is_feature(edge.half_edge);
      const int middle = mesh_.split(edge.half_edge);
      freedom_.push_back(is_feature ? Freedom::on_line : Freedom::full);
      mesh_.each_leaving(middle, [&](int h) {
        add(h);
        add(EditableMesh::next(h));  // has another half-edge now
        if (mesh_.opposite(EditableMesh::last(h)) < 0) add(EditableMesh::last(h));
      });
      for (const LongEdge& added : edges) queue.push(added);
      edges.clear();
    }
  }

  [[noreturn]] void refuse_size() const {
    throw InvalidInput(std::vector<MessagePart>{
        {"RemeshingOptions::edge_length", true},
        {fmt::format(" is {:g} mm, which needs more than the {} triangles of ", edge_length_,
                     options_.max_triangles)},
        {"RemeshingOptions::max_triangles", true},
        {"; raise one of them"}});
  }

  void collapse_short_edges() {
    const double shortest = kShortest * edge_length_;
    for (int h = 0; h < mesh_.half_edge_count(); ++h) {
      report_sometimes(h);
      if (mesh_.is_live(h) && mesh_.length(h) < shortest) collapse(h);
    }
  }

  void collapse(int h) {
    const int a = mesh_.start(h), b = mesh_.end(h);
    if (may_vanish(h)) {
      const bool both_free = freedom(a) == Freedom::full && freedom(b) == Freedom::full;
      try_collapse(h, both_free ? Vector3d((mesh_.at(a) + mesh_.at(b)) / 2) : mesh_.at(b));
    } else if (const int g = mesh_.opposite(h); g >= 0 && may_vanish(g)) {
      try_collapse(g, mesh_.at(a));
    }
  }

  /// Returns true if the start of a half-edge may be merged into its end.
  [[nodiscard]] bool may_vanish(int h) const {
    const int a = mesh_.start(h);
    if (freedom(a) == Freedom::full) return true;
    if (freedom(a) == Freedom::none || !mesh_.is_feature(h)) return false;
    const std::vector<int> ends = along_feature(a);
    return ends.size() == 2 && is_on_line(a, ends[0], ends[1]);
  }

  void try_collapse(int h, const Vector3d& to) {
    const int a = mesh_.start(h), b = mesh_.end(h);
    if (!fits(a, b, to) || !fits(b, a, to) || !mesh_.can_collapse(h)) return;
    mesh_.collapse(h);
    mesh_.move(b, to);
  }

  /// Returns true if `v` can move in the triangles at it, without those that also have `other`.
  [[nodiscard]] bool fits(int v, int other, const Vector3d& to) const {
    const double longest = kLongest * edge_length_;
    bool is_good = true;
    mesh_.each_leaving(v, [&](int h) {
      const int p = mesh_.end(h), q = mesh_.apex(h);
      if (p == other || q == other) return;
      const Vector3d &at_p = mesh_.at(p), &at_q = mesh_.at(q);
      is_good = is_good && (at_p - to).norm() <= longest && (at_q - to).norm() <= longest &&
                !is_turned(area_vector(mesh_.at(v), at_p, at_q), area_vector(to, at_p, at_q));
    });
    return is_good;
  }

  void flip_edges() {
    for (int sweep = 0; sweep < kFlipSweeps; ++sweep) {
      bool flipped = false;
      for (int h = 0; h < mesh_.half_edge_count(); ++h) {
        report_sometimes(h);
        if (!mesh_.is_live(h) || h > mesh_.opposite(h) || !is_worth_flipping(h)) continue;
        mesh_.flip(h);
        flipped = true;
      }
      if (!flipped) break;
    }
  }

  /// Returns true if an edge is not Delaunay, and the other diagonal turns neither triangle.
  [[nodiscard]] bool is_worth_flipping(int h) const {
    const int g = mesh_.opposite(h);
    if (g < 0 || mesh_.is_feature(h)) return false;
    const Vector3d &a = mesh_.at(mesh_.start(h)), &b = mesh_.at(mesh_.end(h)),
                   &c = mesh_.at(mesh_.apex(h)), &d = mesh_.at(mesh_.apex(g));
    // Above rounding, so that no edge is flipped to and fro.
    constexpr double kClear = 1e-9;  // [rad]
    const double angles = angle_opposite(a, b, c) + angle_opposite(a, b, d);
    if (angles <= std::numbers::pi + kClear) return false;
    const Vector3d first = area_vector(a, b, c), second = area_vector(b, a, d);
    for (const Vector3d& made : {area_vector(d, c, a), area_vector(c, d, b)}) {
      if (!(made.squaredNorm() > 0) || is_turned(first, made) || is_turned(second, made))
        return false;
    }
    return mesh_.can_flip(h);
  }

  /// The middle of the triangles at a vertex, weighted with their areas, in its tangential plane.
  [[nodiscard]] Vector3d smoothed(int v) const {
    Vector3d sum = Vector3d::Zero(), normal = Vector3d::Zero();
    double weight = 0;
    mesh_.each_leaving(v, [&](int h) {
      const Vector3d &p = mesh_.at(mesh_.end(h)), &q = mesh_.at(mesh_.apex(h));
      const Vector3d area = area_vector(mesh_.at(v), p, q);
      sum += area.norm() * (mesh_.at(v) + p + q) / 3;
      weight += area.norm();
      normal += area;
    });
    if (!(weight > 0) || !(normal.norm() > 0)) return mesh_.at(v);
    const Vector3d unit = normal.normalized();
    const Vector3d move = sum / weight - mesh_.at(v);
    return mesh_.at(v) + move - unit.dot(move) * unit;
  }

  [[nodiscard]] Vector3d normal_at(int v) const {
    Vector3d normal = Vector3d::Zero();
    mesh_.each_leaving(v, [&](int h) {
      normal += area_vector(mesh_.at(v), mesh_.at(mesh_.end(h)), mesh_.at(mesh_.apex(h)));
    });
    return normal;
  }

  /// Moves the vertices on straight parts of features to the middle between their neighbours.
  void spread_along_features() {
    for (int v = 0; v < mesh_.vertex_count(); ++v) {
      if (!mesh_.is_vertex_live(v) || freedom(v) != Freedom::on_line) continue;
      const std::vector<int> ends = along_feature(v);
      if (ends.size() == 2 && is_on_line(v, ends[0], ends[1]))
        static_cast<void>(try_move(v, (mesh_.at(ends[0]) + mesh_.at(ends[1])) / 2));
    }
  }

  void smooth_and_project() {
    spread_along_features();
    std::vector<int> free;
    for (int v = 0; v < mesh_.vertex_count(); ++v)
      if (mesh_.is_vertex_live(v) && freedom(v) == Freedom::full) free.push_back(v);
    const auto count = static_cast<Eigen::Index>(free.size());
    Eigen::Matrix3Xd wanted(3, 2 * count);  // smoothed, and as it is
    for (Eigen::Index i = 0; i < count; ++i) {
      const int v = free[static_cast<size_t>(i)];
      wanted.col(i) = smoothed(v);
      wanted.col(count + i) = mesh_.at(v);
    }
    report();
    const ClosestPoints places = closest_points(query_, wanted);
    for (Eigen::Index i = 0; i < count; ++i) {
      const int v = free[static_cast<size_t>(i)];
      if (!try_place(v, places, i)) static_cast<void>(try_place(v, places, count + i));
    }
  }

  /// Moves a vertex onto the input unless that is the back of a thin part, or turns a triangle.
  [[nodiscard]] bool try_place(int v, const ClosestPoints& places, Eigen::Index i) {
    const bool is_back = normals_.col(places.triangles[i]).dot(normal_at(v)) < 0;
    return !is_back && try_move(v, places.positions.col(i));
  }

  /// Moves a vertex unless that turns a triangle.
  [[nodiscard]] bool try_move(int v, const Vector3d& to) {
    bool is_good = true;
    mesh_.each_leaving(v, [&](int h) {
      const Vector3d &p = mesh_.at(mesh_.end(h)), &q = mesh_.at(mesh_.apex(h));
      is_good = is_good && !is_turned(area_vector(mesh_.at(v), p, q), area_vector(to, p, q));
    });
    if (is_good) mesh_.move(v, to);
    return is_good;
  }

  const RemeshingOptions& options_;
  double edge_length_;  ///< [mm]
  SurfaceQuery query_;
  Eigen::Matrix3Xd normals_;  ///< of the input's triangles
  EditableMesh mesh_;
  std::vector<Freedom> freedom_;  ///< of each vertex
  int done_ = 0, total_ = 0;
};

/// Refuses before any memory is needed: equilateral triangles of this length have this area.
void check_size(const TriangleMesh& mesh, const RemeshingOptions& options) {
  const double length = *options.edge_length;
  const double each = std::sqrt(3.0) / 4 * length * length;
  const double needed = surface_area(mesh) / each;
  if (needed <= options.max_triangles) return;
  throw InvalidInput(std::vector<MessagePart>{
      {"RemeshingOptions::edge_length", true},
      {fmt::format(" is {:g} mm, which needs about {:.3g} triangles on this surface, more than the "
                   "{} of ",
                   length, needed, options.max_triangles)},
      {"RemeshingOptions::max_triangles", true},
      {fmt::format("; it must be at least {:.3g} mm",
                   length * std::sqrt(needed / options.max_triangles))}});
}

}  // namespace

void visit(RemeshingOptions& options, FieldVisitor& visitor) {
  visitor.begin("RemeshingOptions");
  visitor.real({.name = "edge_length",
                .description = "Make the triangles nearly equilateral, with edges of this length; "
                               "the border and sharp edges stay where they are",
                .unit = "mm",
                .option = "remesh"},
               options.edge_length, above(0).finite());
  visitor.real({"feature_angle",
                "Edges at which the surface bends by more than this are sharp, and stay when it is "
                "remeshed; at 180 degrees only the border does",
                "rad"},
               options.feature_angle, above(0).at_most(std::numbers::pi));
  visitor.whole({.name = "max_triangles",
                 .description = "Refuse to remesh with more triangles than this; each takes about "
                                "200 bytes of memory",
                 .expert = true,
                 .option = "remesh_limit"},
                options.max_triangles, at_least(1));
}

Remeshing remesh(const TriangleMesh& mesh, const RemeshingOptions& options) {
  static_cast<void>(in_range(options));
  require_given("RemeshingOptions::edge_length", options.edge_length.has_value());
  check_mesh(mesh, "remesh");
  check_size(mesh, options);
  return Remesher(mesh, options).run();
}

}  // namespace palpate::geometry
