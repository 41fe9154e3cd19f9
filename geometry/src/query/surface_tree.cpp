// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "query/surface_tree.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "base/numbers.h"
#include "palpate/parallel_for.h"
#include "query/local_frame.h"
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

/// Few lines cross a surface more often, so that memory for the crossings is asked for only once.
constexpr std::size_t kUsualCrossings = 8;

/// At least x, and little more; without the branches of std::nextafter. Precondition: x >= 0.
float round_up(double x) {
  return static_cast<float>(x) * (1 + 2 * std::numeric_limits<float>::epsilon()) +
         std::numeric_limits<float>::min();
}

/// Ties go to the lower index.
bool improves(double candidate, int triangle, double best, int best_triangle) {
  return candidate < best || (candidate == best && best_triangle >= 0 && triangle < best_triangle);
}

/// A squared search radius that includes every triangle within `distance`, if squared distances are
/// computed with such numbers.
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

/// Begins to load what will be read soon.
template <typename What>
void load(const What* first, std::size_t count = 1) {
  for (std::size_t byte = 0; byte < count * sizeof(What); byte += kCacheLine)
    __builtin_prefetch(reinterpret_cast<const char*>(first) + byte);
}

/// Children deferred by a traversal, with their distances.
template <typename Number>
class Stack {
 public:
  struct Entry {
    Number distance;
    int child;
  };
  [[nodiscard]] bool empty() const { return size_ == 0; }
  Entry pop() { return entries_[--size_]; }
  /// Defers all children of a node whose bits are set but the nearest, which is returned, and
  /// begins to load them. Precondition: a bit is set.
  int defer_others(const BoundingTree& tree, const TreeNode& node,
                   const ChildLanes<Number>& distances, unsigned bits) {
    const auto first_entry = [&](unsigned set) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(set));
      return Entry{.distance = distances.data()[lane], .child = node.child[lane]};
    };
    Entry nearest = first_entry(bits);
    for (bits &= bits - 1; bits != 0; bits &= bits - 1) {
      Entry other = first_entry(bits);
      if (other.distance < nearest.distance) std::swap(nearest, other);
      if (other.child < 0) {
        load(&tree.packets[static_cast<std::size_t>(~other.child)]);
      } else {
        load(&tree.nodes[static_cast<std::size_t>(other.child)]);
      }
      entries_[size_++] = other;
    }
    return nearest.child;
  }

 private:
  // Not zero-initialised, because that would cost as much as a short traversal.
  std::array<Entry, std::size_t{TreeNode::kSize - 1} * BoundingTree::kMaxDepth> entries_;
  std::size_t size_ = 0;
};

/// Walks down the tree, to the nearest child first. Distances are such numbers.
/// \param meet finds the children of a node that matter, and their distances.
/// \param look_at looks at the packet with this number.
/// \param limit is asked for the distance beyond which nothing matters any more.
template <typename Number>
void walk(const BoundingTree& tree, const auto& meet, const auto& look_at, const auto& limit) {
  Stack<Number> stack;
  int at = 0;  // the root
  while (true) {
    if (at < 0) {
      look_at(~at);
    } else {
      const TreeNode& node = tree.nodes[static_cast<std::size_t>(at)];
      ChildLanes<Number> distances;
      if (const unsigned bits = meet(node, distances); bits != 0) {
        at = stack.defer_others(tree, node, distances, bits);
        continue;
      }
    }
    typename Stack<Number>::Entry next{};
    do {
      if (stack.empty()) return;
      next = stack.pop();
    } while (next.distance > limit());
    at = next.child;
  }
}

/// A segment in float that meets the side of a box at the fraction (side - origin) * inverse of its
/// length.
struct SlabSegment {
  std::array<BoxLanes, 3> origin, inverse;
  std::array<std::size_t, 3> near_side;  ///< index of the side where it enters a box

  SlabSegment(const Eigen::Vector3d& start, const Eigen::Vector3d& end) {
    // A segment parallel to a side of a box is tilted by less than its rounding.
    constexpr float kLeast = 1e-18F;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<int>(k);
      const auto along = static_cast<float>(end[axis] - start[axis]);
      near_side[k] = std::signbit(along) ? 1 : 0;
      origin[k] = BoxLanes::Constant(static_cast<float>(start[axis]));
      inverse[k] = BoxLanes::Constant(1 / std::copysign(std::max(std::abs(along), kLeast), along));
    }
  }
  /// Finds the boxes that it enters before `far`, and where.
  [[nodiscard]] unsigned meet(const TreeNode& node, float far, BoxLanes& enter) const {
    enter = BoxLanes::Zero();
    BoxLanes leave = BoxLanes::Constant(far);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::array<BoxLanes, 2>& sides = node.sides[axis];
      enter = enter.max((sides[near_side[axis]] - origin[axis]) * inverse[axis]);
      leave = leave.min((sides[1 - near_side[axis]] - origin[axis]) * inverse[axis]);
    }
    return where_not_above(enter, leave);
  }
};

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
  const LocalFrame frame = local_frame(mesh_.vertices);
  centre_ = frame.centre;
  scale_ = frame.scale;
  const double largest = mesh_.vertices.cwiseAbs().maxCoeff();
  on_surface_ = std::min(kOnSurface * largest * scale_, 1.0);
  margin_ = std::max(kFloatMargin, 4 * on_surface_);
  return frame.to_local(mesh_.vertices);
}

/// What a closest-point query has found.
struct SurfaceTree::FoundNearest {
  NearestTriangle best;
  double squared_others = kInfinity;  ///< of the second nearest triangle, if it matters
};

/// State of a closest-point query that culls with such numbers.
template <typename Number>
struct SurfaceTree::NearestSearch {
  Eigen::Vector3d point;
  Eigen::Matrix<Number, 3, 1> culling_point;
  double reach;  ///< largest coordinate of the point
  double slack;  ///< triangles matter iff they are at most this much farther away than the nearest
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
      if (triangle != best.triangle)
        found.squared_others = std::min(found.squared_others, candidate.squared_distance);
      return;
    }
    found.squared_others = best.at.squared_distance;
    best = {.at = candidate, .triangle = triangle, .place = place};
    squared_radius = std::min(
        squared_radius,
        geometry::squared_radius<Number>(std::sqrt(candidate.squared_distance) + slack, reach));
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
  // In double a box needs no margin but for the rounding of its sides.
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
  walk<Number>(
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

/// The packet with this number; begins to load the exact corners of its triangles too.
const TrianglePacket& SurfaceTree::start_packet(int number) const {
  const auto packet = static_cast<std::size_t>(number);
  if (!corners_.empty()) load(&corners_[packet * TrianglePacket::kSize], TrianglePacket::kSize);
  return tree_.packets[packet];
}

/// State of a segment query.
struct SurfaceTree::CrossingSearch {
  const Eigen::Vector3d &start, &end;
  ShearedSegment segment;
  SegmentLanes lanes;
  float length;              ///< along the main axis
  float far = 1;             ///< fraction of the segment up to which crossings matter
  CrossedTriangle best;      ///< between the ends
  NearestTriangle at_start;  ///< triangles on which an end lies
  NearestTriangle at_end;

  CrossingSearch(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double margin)
      : start(from),
        end(to),
        segment(from, to),
        lanes(from, segment, margin),
        length(static_cast<float>(std::abs(segment.length()))) {}
};

/// Keeps the triangle if it is the nearest to `end` of those that touch it.
void SurfaceTree::touch(NearestTriangle& nearest, const Eigen::Vector3d& end, int triangle,
                        int place) const {
  const Nearest candidate = nearest_on_triangle(end, local_corners(place));
  if (std::sqrt(candidate.squared_distance) <= on_surface_ &&
      improves(candidate.squared_distance, triangle, nearest.at.squared_distance,
               nearest.triangle)) {
    nearest = {.at = candidate, .triangle = triangle, .place = place};
  }
}

void SurfaceTree::look_at(CrossingSearch& search, int number) const {
  const TrianglePacket& packet = start_packet(number);
  const float margin = search.lanes.margin();
  const Passing passing = search.lanes.pass(packet);
  const Lanes away = passing.miss.max(-margin - passing.end)
                         .max(passing.begin - (search.far * search.length + margin));
  unsigned bits = where_not_above(away, Lanes::Zero());
  for (; bits != 0; bits &= bits - 1) {
    const int lane = std::countr_zero(bits);
    const int triangle = packet.triangle[static_cast<std::size_t>(lane)];
    if (triangle < 0) continue;
    const int place = TrianglePacket::kSize * number + lane;
    const Crossing candidate = cross_triangle(search.segment, local_corners(place));
    if (improves(candidate.fraction, triangle, search.best.at.fraction, search.best.triangle)) {
      search.best = {.at = candidate, .triangle = triangle, .place = place};
      search.far = std::min(search.far, round_up(candidate.fraction));
    }
    if (passing.begin[lane] <= margin) touch(search.at_start, search.start, triangle, place);
    if (passing.end[lane] >= search.length - margin)
      touch(search.at_end, search.end, triangle, place);
  }
}

CrossedTriangle SurfaceTree::first_crossing(const Eigen::Vector3d& start,
                                            const Eigen::Vector3d& end) const noexcept {
  if (start == end) {
    const NearestTriangle touched = nearest(start, on_surface_);
    if (std::sqrt(touched.at.squared_distance) > on_surface_) return {};
    return {
        {.fraction = 0, .barycentric = touched.at.barycentric}, touched.triangle, touched.place};
  }
  const SlabSegment slabs(start, end);
  CrossingSearch search(start, end, margin_);
  walk<float>(
      tree_,
      [&](const TreeNode& node, BoxLanes& enter) { return slabs.meet(node, search.far, enter); },
      [&](int packet) { look_at(search, packet); }, [&] { return search.far; });
  if (search.at_start.triangle >= 0) {
    return {{.fraction = 0, .barycentric = search.at_start.at.barycentric},
            search.at_start.triangle,
            search.at_start.place};
  }
  if (search.best.triangle < 0 && search.at_end.triangle >= 0) {
    return {{.fraction = 1, .barycentric = search.at_end.at.barycentric},
            search.at_end.triangle,
            search.at_end.place};
  }
  return search.best;
}

bool SurfaceTree::touches(const Eigen::Vector3d& end, int place) const {
  return std::sqrt(nearest_on_triangle(end, local_corners(place)).squared_distance) <= on_surface_;
}

std::vector<CrossedTriangle> SurfaceTree::all_crossings(const Eigen::Vector3d& start,
                                                        const Eigen::Vector3d& end) const {
  std::vector<CrossedTriangle> crossings;
  if (start == end) {
    const CrossedTriangle touched = first_crossing(start, end);
    if (touched.triangle >= 0) crossings.push_back(touched);
    return crossings;
  }
  const SlabSegment slabs(start, end);
  const ShearedSegment segment(start, end);
  const SegmentLanes lanes(start, segment, margin_);
  const auto length = static_cast<float>(std::abs(segment.length()));
  const auto look_at = [&](int number) {
    const TrianglePacket& packet = start_packet(number);
    const Passing passing = lanes.pass(packet);
    const Lanes away = passing.miss.max(-lanes.margin() - passing.end)
                           .max(passing.begin - (length + lanes.margin()));
    for (unsigned bits = where_not_above(away, Lanes::Zero()); bits != 0; bits &= bits - 1) {
      const int lane = std::countr_zero(bits);
      const int triangle = packet.triangle[static_cast<std::size_t>(lane)];
      if (triangle < 0) continue;
      const int place = TrianglePacket::kSize * number + lane;
      Crossing crossing = cross_triangle_beside_edges(segment, local_corners(place));
      if (!(std::abs(crossing.fraction) < kInfinity)) continue;
      if (crossing.fraction < 0) {
        if (!touches(start, place)) continue;
        crossing.fraction = 0;
      } else if (crossing.fraction > 1) {
        if (!touches(end, place)) continue;
        crossing.fraction = 1;
      }
      if (crossings.empty()) crossings.reserve(kUsualCrossings);
      crossings.push_back({.at = crossing, .triangle = triangle, .place = place});
    }
  };
  walk<float>(
      tree_, [&](const TreeNode& node, BoxLanes& enter) { return slabs.meet(node, 1, enter); },
      look_at, [] { return 1.0F; });
  const auto place = [](const CrossedTriangle& one) {
    return std::pair(one.at.fraction, one.triangle);
  };
  std::sort(crossings.begin(), crossings.end(),
            [&](const auto& a, const auto& b) { return place(a) < place(b); });
  return crossings;
}

}  // namespace palpate::geometry
