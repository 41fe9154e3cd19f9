// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "query/distance_bound.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "base/numbers.h"
#include "mesh/edge_table.h"
#include "mesh/triangle_primitives.h"
#include "palpate/core/error.h"
#include "palpate/core/parallel_for.h"
#include "palpate/geometry/mesh_measures.h"
#include "query/distance_piece.h"

namespace palpate::geometry {
namespace {

/// Triangles per task: few, because those that are subdivided take far longer than others.
constexpr std::ptrdiff_t kTrianglesPerTask = 64;

/// Triangles that are refined only down to the largest distance found in those before them. The
/// number is fixed, so that the result does not depend on the number of threads.
constexpr std::size_t kTrianglesPerBatch = 4096;

/// Fraction of the diagonal of both meshes below which bounds need not be distinguished. Far above
/// the rounding of distances, far below any measured distance.
constexpr double kLeastGap = 1e-9;

/// A corner is off a cutting line iff its distance from it exceeds this fraction of the piece's
/// size, and the rounding of corners. Corners made by a cut are on their line except for rounding,
/// and must not be cut again.
constexpr double kOnLine = 1e-9;

/// Bound of the rounding of corners after many cuts, as a fraction of the diagonal of both meshes.
constexpr double kCornerRounding = 64 * std::numeric_limits<double>::epsilon();

/// After this many consecutive cuts a piece is halved, because cuts alone may not terminate where
/// the target's triangles are perpendicular to the piece.
constexpr int kMostCuts = 8;

/// A piece wider than this many times its target triangle is halved before it is cut, because long
/// cuts across a large piece leave many slivers.
constexpr double kCutWidth = 4;

/// Number of pieces of one triangle, and more for each triangle of the target, after which the
/// bounds of the others are taken as they are. In the second half of them nothing is cut, because
/// cuts between needles of the target may go on for very long. Scans need some 1000.
constexpr double kMostPieces = 20'000;
constexpr double kMorePieces = 64;

/// A triangle is a line iff twice its area is at most this fraction of its longest edge squared: a
/// few roundings.
constexpr double kLeastSine = 8 * std::numeric_limits<double>::epsilon();

Corners corners_of(const TriangleMesh& mesh, Eigen::Index triangle) {
  const Eigen::Vector3i of = mesh.triangles.col(triangle);
  return {mesh.vertices.col(of[0]), mesh.vertices.col(of[1]), mesh.vertices.col(of[2])};
}

double longest_edge(const Corners& c) {
  return std::sqrt(std::max(
      {(c[1] - c[0]).squaredNorm(), (c[2] - c[1]).squaredNorm(), (c[0] - c[2]).squaredNorm()}));
}

/// Bounds the distance of one triangle's points.
class TriangleSearch {
 public:
  /// \param size [mm] diagonal of both meshes.
  TriangleSearch(const DistanceTarget& to, const BoundGoal& goal, double size, double known)
      : to_(to),
        goal_(goal),
        least_gap_(kLeastGap * size),
        rounding_(kCornerRounding * size),
        most_pieces_(kMostPieces + kMorePieces * static_cast<double>(to.mesh.triangles.cols())),
        known_(known) {}

  /// `nearest`: closest point of each corner.
  TriangleBound run(const Corners& corners, const std::array<ClosestPoint, 3>& nearest) {
    witnesses_ = {};
    found_ = {.lower = nearest[0].distance, .upper = 0, .at = corners[0]};
    for (std::size_t k = 1; k < 3; ++k) raise(nearest[k].distance, corners[k]);
    DistancePiece whole = whole_triangle(corners);
    double least = kInfinity;
    for (const ClosestPoint& candidate : nearest) {
      const double bound = distances(whole, candidate.at.triangle).maxCoeff();
      if (bound < least) {
        least = bound;
        whole.triangle = candidate.at.triangle;
      }
    }
    todo_.assign(1, whole);
    for (pieces_ = 0; !todo_.empty() && found_.lower <= goal_.stop_above; ++pieces_) {
      const DistancePiece piece = todo_.back();
      todo_.pop_back();
      if (pieces_ < most_pieces_) {
        treat(piece);
      } else {
        settle(piece);
      }
    }
    found_.upper = todo_.empty() ? std::max(found_.upper, found_.lower) : kInfinity;
    return {.largest = found_, .witnesses = witnesses_};
  }

 private:
  using CornerDistances = Eigen::Array<double, Eigen::Dynamic, 1, 0, kMostPieceCorners, 1>;

  /// Treats a triangle without area as its longest edge.
  DistancePiece whole_triangle(const Corners& corners) {
    const double longest = longest_edge(corners);
    const Eigen::Vector3d area = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    DistancePiece whole;
    normal_.setZero();
    if (area.norm() > kLeastSine * longest * longest) {
      normal_ = area.stableNormalized();
      for (const Eigen::Vector3d& corner : corners) whole.add(corner);
      return whole;
    }
    for (std::size_t k = 0; k < 3 && whole.count == 0; ++k) {
      if ((corners[(k + 1) % 3] - corners[k]).norm() < longest) continue;
      whole.add(corners[k]);
      whole.add(corners[(k + 1) % 3]);
    }
    return whole;
  }

  CornerDistances distances(const DistancePiece& piece, int triangle) const {
    const Corners target = corners_of(to_.mesh, triangle);
    CornerDistances of(piece.count);
    for (int i = 0; i < piece.count; ++i) {
      of[i] = std::sqrt(nearest_on_triangle(piece.corner(i), target).squared_distance);
    }
    return of;
  }

  /// A piece is finished once its distance cannot exceed this.
  [[nodiscard]] double enough() const {
    const double lower = std::max(known_, found_.lower);
    return std::max(goal_.ignore_below, lower + std::max(goal_.max_gap * lower, least_gap_));
  }

  /// `upper` follows from the distances to this triangle.
  bool done(double upper, int triangle) {
    if (!(upper <= enough())) return false;
    accept(upper, triangle);
    return true;
  }

  void accept(double upper, int triangle) {
    found_.upper = std::max(found_.upper, upper);
    witnesses_.add(triangle);
  }

  ClosestPoint ask(const Eigen::Vector3d& point) {
    ClosestPoint closest = to_.query.closest_point(point);
    raise(closest.distance, point);
    return closest;
  }

  void raise(double distance, const Eigen::Vector3d& at) {
    if (distance > found_.lower) {
      found_.lower = distance;
      found_.at = at;
    }
  }

  void treat(const DistancePiece& piece) {
    if (piece.triangle < 0) return ask_centre(piece);
    const CornerDistances distance = distances(piece, piece.triangle);
    int worst = 0;
    const double upper = distance.maxCoeff(&worst);
    if (done(upper, piece.triangle)) return;
    const Eigen::Vector3d centre = piece.centre();
    const double width = 2 * piece.reach(centre);
    if (width <= least_gap_) return ask_centre(piece);  // which ends it
    const Corners target = corners_of(to_.mesh, piece.triangle);
    if (width > kCutWidth * longest_edge(target)) {
      return piece.asked ? halve(piece) : ask_centre(piece);
    }
    if (cut(piece, target, distance, std::max(kOnLine * width, rounding_))) return;
    if (!piece.asked) return ask_centre(piece);
    const ClosestPoint closest = ask(piece.corner(worst));
    if (done(closest.distance + width, closest.at.triangle)) return;
    halve(piece);
  }

  void ask_centre(DistancePiece piece) {
    const Eigen::Vector3d centre = piece.centre();
    const ClosestPoint closest = ask(centre);
    if (done(closest.distance + piece.reach(centre), closest.at.triangle)) return;
    piece.triangle = closest.at.triangle;
    piece.asked = true;
    todo_.push_back(piece);
  }

  /// Takes the bound by the triangle nearest to the centre, however loose it is.
  void settle(const DistancePiece& piece) {
    const int nearest = ask(piece.centre()).at.triangle;
    accept(distances(piece, nearest).maxCoeff(), nearest);
  }

  /// Cuts along the edge of the target's triangle beyond which the too distant corners are
  /// farthest, seen along the normal; false if there is none.
  bool cut(const DistancePiece& piece, const Corners& target, const CornerDistances& distance,
           double on_line) {
    if (pieces_ > most_pieces_ / 2) return false;
    if (piece.cuts >= kMostCuts || piece.count > kMostToCut) return false;
    const double limit = enough();
    double furthest = -on_line;
    int edge = -1;
    CutLine line{.point = Eigen::Vector3d::Zero(), .normal = Eigen::Vector3d::Zero()};
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3d& from = target[k];
      const Eigen::Vector3d across = (target[(k + 1) % 3] - from).cross(normal_);
      const double inwards = across.dot(target[(k + 2) % 3] - from);
      if (inwards == 0) continue;
      const Eigen::Vector3d normal = (inwards > 0 ? 1 : -1) * across.stableNormalized();
      double beyond = 0;
      double within = 0;
      for (int i = 0; i < piece.count; ++i) {
        const double side = normal.dot(piece.corner(i) - from);
        if (distance[i] > limit) beyond = std::min(beyond, side);
        within = std::max(within, side);
      }
      if (within > on_line && beyond < furthest) {
        furthest = beyond;
        edge = static_cast<int>(k);
        line = {.point = from, .normal = normal};
      }
    }
    if (edge < 0) return false;
    auto [inside, outside] = cut_in_two(piece, line, on_line);
    outside.triangle = to_.neighbours(edge, piece.triangle);
    inside.asked = piece.asked;
    inside.cuts = outside.cuts = piece.cuts + 1;
    todo_.push_back(outside);
    todo_.push_back(inside);
    return true;
  }

  /// Halves it across its longest diagonal.
  void halve(const DistancePiece& piece) {
    if (piece.count > kMostToCut) return part(piece);
    int from = 0, to = 1;
    double longest = -1;
    for (int i = 0; i < piece.count; ++i) {
      for (int j = i + 1; j < piece.count; ++j) {
        const double length = (piece.corner(i) - piece.corner(j)).squaredNorm();
        if (length > longest) {
          longest = length;
          from = i;
          to = j;
        }
      }
    }
    const Eigen::Vector3d along = piece.corner(to) - piece.corner(from);
    const auto [one, other] = cut_in_two(
        piece, {.point = piece.corner(from) + along / 2, .normal = along.stableNormalized()},
        rounding_);
    todo_.push_back(one);
    todo_.push_back(other);
  }

  /// Two parts with fewer corners.
  void part(const DistancePiece& piece) {
    DistancePiece one, other;
    one.triangle = other.triangle = piece.triangle;
    const int middle = piece.count / 2;
    for (int i = 0; i <= middle; ++i) one.add(piece.corner(i));
    for (int i = middle; i < piece.count; ++i) other.add(piece.corner(i));
    other.add(piece.corner(0));
    todo_.push_back(one);
    todo_.push_back(other);
  }

  const DistanceTarget& to_;
  const BoundGoal& goal_;
  double least_gap_;  ///< [mm]
  double rounding_;   ///< [mm] of corners
  double most_pieces_;
  double known_;       ///< [mm] distance of some point: a lower bound
  double pieces_ = 0;  ///< treated so far, of this triangle
  Eigen::Vector3d normal_;
  LargestDistance found_{};
  Witnesses witnesses_;
  std::vector<DistancePiece> todo_;
};

}  // namespace

DistanceTarget::DistanceTarget(TriangleMesh surface)
    : mesh(std::move(surface)),
      query(mesh),
      neighbours(triangle_neighbours(mesh.triangles)),
      box(bounding_box(mesh)) {}

void Witnesses::add(int triangle) {
  if (!is_complete() || std::ranges::find(all(), triangle) != all().end()) return;
  if (count < kMost) triangles[static_cast<std::size_t>(count)] = triangle;
  ++count;
}

std::vector<TriangleBound> bound_triangle_distances(const TriangleMesh& from,
                                                    std::span<const int> which,
                                                    const DistanceTarget& to,
                                                    const BoundGoal& goal) {
  // Start with the vertices: they give first bounds and candidate triangles.
  std::vector<int> place(static_cast<std::size_t>(from.vertices.cols()), -1);
  std::vector<int> used;
  for (const int triangle : which) {
    for (const int vertex : from.triangles.col(triangle)) {
      int& of_vertex = place[static_cast<std::size_t>(vertex)];
      if (of_vertex >= 0) continue;
      of_vertex = static_cast<int>(used.size());
      used.push_back(vertex);
    }
  }
  std::vector<ClosestPoint> of_vertex(used.size());
  parallel_for(used.size(), [&](std::size_t i) {
    of_vertex[i] = to.query.closest_point(from.vertices.col(used[i]));
  });
  double known = 0;
  Eigen::AlignedBox3d box = to.box;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (of_vertex[i].at.triangle < 0) {
      throw InvalidInput("the surfaces lie so far apart that distances overflow (vertex " +
                         std::to_string(used[i]) + "); are both in mm?");
    }
    known = std::max(known, of_vertex[i].distance);
    box.extend(from.vertices.col(used[i]));
  }
  const double size = box.diagonal().norm();
  // If there is a limit, triangles are compared with it and not with each other.
  const bool is_limited = goal.stop_above < kInfinity;
  if (is_limited) known = 0;
  std::vector<TriangleBound> bounds(which.size());
  const std::size_t batch = is_limited ? which.size() : kTrianglesPerBatch;
  for (std::size_t first = 0; first < which.size(); first += batch) {
    const std::size_t count = std::min(batch, which.size() - first);
    // Process each triangle independently, so that the result does not depend on the thread order.
    parallel_ranges(
        static_cast<std::ptrdiff_t>(count), kTrianglesPerTask,
        [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
          TriangleSearch search(to, goal, size, known);
          for (auto i = first + static_cast<std::size_t>(begin);
               i != first + static_cast<std::size_t>(end); ++i) {
            std::array<ClosestPoint, 3> of_corner;
            for (std::size_t k = 0; k < 3; ++k) {
              const int vertex = from.triangles(static_cast<Eigen::Index>(k), which[i]);
              of_corner[k] =
                  of_vertex[static_cast<std::size_t>(place[static_cast<std::size_t>(vertex)])];
            }
            bounds[i] = search.run(corners_of(from, which[i]), of_corner);
          }
        });
    for (std::size_t i = first; !is_limited && i < first + count; ++i)
      known = std::max(known, bounds[i].largest.lower);
  }
  return bounds;
}

LargestDistance bound_largest_distance(const TriangleMesh& from, const DistanceTarget& to,
                                       const BoundGoal& goal) {
  std::vector<int> all(static_cast<std::size_t>(from.triangles.cols()));
  std::iota(all.begin(), all.end(), 0);
  const std::vector<TriangleBound> bounds = bound_triangle_distances(from, all, to, goal);
  LargestDistance largest = bounds.front().largest;
  for (const auto& [found, witnesses] : bounds) {
    largest.upper = std::max(largest.upper, found.upper);
    if (found.lower > largest.lower) {
      largest.lower = found.lower;
      largest.at = found.at;
    }
  }
  return largest;
}

}  // namespace palpate::geometry
