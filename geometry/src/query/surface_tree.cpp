// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "query/surface_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "base/numbers.h"
#include "palpate/core/parallel_for.h"
#include "query/local_frame.h"
#include "query/tree_walk.h"
#include "query/triangle_packet.h"

namespace palpate::geometry {
namespace {

/// Points with a larger coordinate (local frame) are culled in double: from farther away the margin
/// of single precision lets ever more boxes pass, first those of flat surfaces.
constexpr double kFloatReach = 16;

/// Points with a larger coordinate (local frame) are first moved this near, towards the mesh, where
/// double still tells triangles apart. Compared with each other, the distances of triangles change
/// by less than they are rounded. An exception remains: the triangles of a flat surface seen
/// straight from its front are equally far away within rounding from about 1e6 on, and more and
/// more of them are tested.
constexpr double kFarthest = 0x1p30;

/// Bound of the rounding of squared distances in double, relative to them.
constexpr double kDoubleMargin = 16 * std::numeric_limits<double>::epsilon();

/// An end of a segment is on the surface iff its distance from it is at most this fraction of the
/// largest coordinate of the mesh, but never more than the mesh's size. This is the rounding of a
/// position computed from barycentric coordinates.
constexpr double kOnSurface = 8 * std::numeric_limits<double>::epsilon();

/// A refitted tree is rebuilt if traversing it costs this many times as much as when it was built.
constexpr double kRebuildCost = 1.5;

/// A squared search radius that includes every triangle within `distance`, if squared distances are
/// computed in `Number`.
/// \param reach largest coordinate of the point.
template <typename Number>
Number squared_radius(double distance, double reach) {
  if (!(distance < kInfinity)) return std::numeric_limits<Number>::infinity();
  if constexpr (std::is_same_v<Number, double>) {
    return distance * distance * (1 + kDoubleMargin);
  } else {
    const double radius = distance * (1 + kFloatMargin) + kFloatMargin * (1 + reach);
    return round_up(radius * radius);
  }
}

}  // namespace

SurfaceTree::SurfaceTree(const TriangleMesh& mesh, TreeBuild build_as)
    : mesh_(mesh), build_(build_as) {
  build(set_frame());
}

void SurfaceTree::build(const Eigen::Matrix3Xd& local) {
  tree_ = build_tree(local, mesh_.triangles, 2 * margin_, build_);
  set_corners();
  built_cost_ = walking_cost(tree_);
}

void SurfaceTree::move_vertices(const Eigen::Ref<const Eigen::Matrix3Xd>& vertices) {
  mesh_.vertices = vertices;
  const Eigen::Matrix3Xd local = set_frame();
  refit(tree_, local, mesh_.triangles, 2 * margin_);
  set_corners();
  if (walking_cost(tree_) > kRebuildCost * built_cost_) build(local);
}

void SurfaceTree::set_corners() {
  if (build_ == TreeBuild::quick) return;
  constexpr std::size_t kSize = TrianglePacket::kSize;
  corners_.resize(kSize * tree_.packets.size());
  parallel_for(corners_.size(), [&](std::size_t place) {
    const int triangle = tree_.packets[place / kSize].triangle[place % kSize];
    if (triangle < 0) return;
    for (int k = 0; k < 3; ++k) {
      corners_[place][static_cast<std::size_t>(k)] =
          mesh_.vertices.col(mesh_.triangles(k, triangle));
    }
  });
}

Eigen::Matrix3Xd SurfaceTree::set_frame() {
  const Eigen::AlignedBox3d box = bounding_box(mesh_);
  const LocalFrame frame = local_frame(box);
  centre_ = frame.centre;
  scale_ = frame.scale;
  const double largest = box.max().cwiseMax(-box.min()).maxCoeff();
  on_surface_ = std::min(kOnSurface * largest * scale_, 1.0);
  margin_ = std::max(kFloatMargin, 4 * on_surface_);
  return frame.to_local(mesh_.vertices);
}

/// The result of a closest-point query.
struct SurfaceTree::FoundNearest {
  NearestTriangle best;
  double squared_others = kInfinity;  ///< of the second nearest triangle, if it matters
};

/// State of a closest-point query that culls in `Number`.
template <typename Number>
struct SurfaceTree::NearestSearch {
  Eigen::Vector3d point;
  Eigen::Matrix<Number, 3, 1> culling_point;
  double reach;  ///< largest coordinate of the point
  double slack;  ///< triangles matter if they are at most this much farther away than the nearest
  Number squared_radius;
  FoundNearest& found;

  NearestSearch(FoundNearest& result, const Eigen::Vector3d& at, double radius, double more)
      : point(at),
        culling_point(at.cast<Number>()),
        reach(at.cwiseAbs().maxCoeff()),
        slack(more),
        squared_radius(geometry::squared_radius<Number>(radius, reach)),
        found(result) {}

  void look_at(const Nearest& candidate, int triangle, int place) {
    NearestTriangle& best = found.best;
    if (!improves(candidate.squared_distance, triangle, best.at.squared_distance, best.triangle)) {
      if (triangle == best.triangle || !(candidate.squared_distance < found.squared_others)) return;
      found.squared_others = candidate.squared_distance;
    } else {
      found.squared_others = best.at.squared_distance;
      best = {.at = candidate, .triangle = triangle, .place = place};
    }
    // Whatever is farther away than the second nearest does not matter, however large the slack.
    const double distance = std::sqrt(best.at.squared_distance);
    const double matters =
        slack > 0 ? std::min(distance + slack, std::sqrt(found.squared_others)) : distance;
    squared_radius = std::min(squared_radius, geometry::squared_radius<Number>(matters, reach));
  }
};

template <typename Number>
void SurfaceTree::look_at(NearestSearch<Number>& search, int number) const {
  const TrianglePacket& packet = tree_.packets[static_cast<std::size_t>(number)];
  auto squared = squared_distances(search.culling_point, packet);
  for (int i = 0; i < TrianglePacket::kSize; ++i) {
    int lane = 0;
    // Usually the nearest of the four makes testing the others unnecessary.
    if (!(squared.minCoeff(&lane) <= search.squared_radius)) break;
    squared[lane] = std::numeric_limits<Number>::infinity();
    const int triangle = packet.triangle[static_cast<std::size_t>(lane)];
    if (triangle < 0) continue;
    const int place = TrianglePacket::kSize * number + lane;
    search.look_at(nearest_on_triangle(search.point, local_corners(place)), triangle, place);
  }
}

template <typename Number>
SurfaceTree::FoundNearest SurfaceTree::find(const Eigen::Vector3d& point, int guess, double radius,
                                            double slack) const {
  FoundNearest found;
  NearestSearch<Number> search(found, point, radius, slack);
  if (guess >= 0) {
    search.look_at(nearest_on_triangle(point, local_corners(guess)), triangle_at(guess), guess);
  }
  const std::array<ChildLanes<Number>, 3> p = {
      ChildLanes<Number>::Constant(search.culling_point[0]),
      ChildLanes<Number>::Constant(search.culling_point[1]),
      ChildLanes<Number>::Constant(search.culling_point[2])};
  // In double a box needs no margin except for the rounding of its sides.
  constexpr double kSideRounding = std::numeric_limits<float>::epsilon();
  const double spare = 2 * margin_ - (1 + 2 * margin_) * kSideRounding;
  const auto meet = [&](const TreeNode& node, ChildLanes<Number>& squared) {
    squared = ChildLanes<Number>::Zero();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto& [lower, upper] = node.sides[axis];
      ChildLanes<Number> outside =
          (lower.template cast<Number>() - p[axis]).max(p[axis] - upper.template cast<Number>());
      if constexpr (std::is_same_v<Number, double>) outside += spare;
      outside = outside.max(Number{0});
      squared += outside * outside;
    }
    return where_not_above(squared, ChildLanes<Number>::Constant(search.squared_radius)) &
           node.children;
  };
  walk_tree<Number>(
      tree_, meet, [&](int packet) { look_at(search, packet); },
      [&] { return search.squared_radius; });
  return found;
}

SurfaceTree::FoundNearest SurfaceTree::find_from_beyond(const Eigen::Vector3d& point, int guess,
                                                        double radius, double slack) const {
  const double nearer = kFarthest / point.cwiseAbs().maxCoeff();
  FoundNearest found = find<double>(nearer * point, guess, radius, slack);
  NearestTriangle& best = found.best;
  if (best.triangle < 0) return found;
  best.at.squared_distance =
      (point - point_on(local_corners(best.place), best.at.barycentric)).squaredNorm();
  if (!(best.at.squared_distance < kInfinity)) return {};
  // The others are as far away, except for rounding.
  found.squared_others = best.at.squared_distance;
  return found;
}

SurfaceTree::FoundNearest SurfaceTree::find(const Eigen::Vector3d& point, int guess, double radius,
                                            double slack) const {
  const double reach = point.cwiseAbs().maxCoeff();
  if (reach <= kFloatReach) return find<float>(point, guess, radius, slack);
  if (reach <= kFarthest) return find<double>(point, guess, radius, slack);
  return find_from_beyond(point, guess, radius, slack);
}

NearestTriangle SurfaceTree::nearest(const Eigen::Vector3d& point, double radius) const noexcept {
  return find(point, -1, radius, 0).best;
}

LoneNearest SurfaceTree::lone_nearest(const Eigen::Vector3d& point, int guess,
                                      double slack) const noexcept {
  const FoundNearest found = find(point, guess, kInfinity, slack);
  const double distance = std::sqrt(found.best.at.squared_distance);
  return {.nearest = found.best,
          .others = std::min(std::sqrt(found.squared_others), distance + slack)};
}

}  // namespace palpate::geometry
