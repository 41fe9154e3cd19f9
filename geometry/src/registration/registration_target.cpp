// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "registration/registration_target.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/numbers.h"
#include "mesh/compact_mesh.h"
#include "mesh/edge_table.h"
#include "palpate/core/error.h"
#include "palpate/core/module.h"
#include "palpate/core/parallel_for.h"
#include "palpate/core/require.h"
#include "registration/registration_pcl.h"

namespace palpate::geometry {
namespace {

/// Points per task.
constexpr Eigen::Index kPointsPerTask = 64;

/// Points between two reports: some hundredths of a second.
constexpr Eigen::Index kPointsPerReport = 1 << 14;

/// On the coarse map, a point more than two cells away is beside the surface if at most this share
/// of the way to it is along the normal.
constexpr double kAlongNormal = 0.7;

const TriangleMesh& checked(const TriangleMesh& mesh) {
  check_mesh(mesh, "register_points: the target");
  const auto has_area = [&](const auto& triangle) {
    return unit_normal({mesh.vertices.col(triangle[0]), mesh.vertices.col(triangle[1]),
                        mesh.vertices.col(triangle[2])})
        .allFinite();
  };
  const auto triangles = mesh.triangles.colwise();
  if (std::none_of(triangles.begin(), triangles.end(), has_area)) {
    throw InvalidInput(
        "register_points: the target: no triangle has an area; a surface is needed to register to");
  }
  return mesh;
}

/// Returns the vertices that may be on the border, few of which are not: around an inner vertex
/// each neighbour follows as often as it precedes, so that the sum of scrambled neighbours is 0.
std::vector<bool> maybe_on_border(const TriangleMesh& mesh) {
  constexpr std::uint64_t kScramble = 0x9e3779b97f4a7c15U;  // odd, 2^64 over the golden ratio
  const auto scrambled = [](int vertex) {
    std::uint64_t x = (static_cast<std::uint64_t>(vertex) + 1) * kScramble;
    x ^= x >> 32U;
    return x * kScramble;
  };
  std::vector<std::uint64_t> sums(static_cast<size_t>(mesh.vertices.cols()));
  for (const auto& triangle : mesh.triangles.colwise()) {
    const std::array<std::uint64_t, 3> names = {scrambled(triangle[0]), scrambled(triangle[1]),
                                                scrambled(triangle[2])};
    sums[static_cast<size_t>(triangle[0])] += names[1] - names[2];
    sums[static_cast<size_t>(triangle[1])] += names[2] - names[0];
    sums[static_cast<size_t>(triangle[2])] += names[0] - names[1];
  }
  std::vector<bool> maybe(sums.size());
  std::transform(sums.begin(), sums.end(), maybe.begin(),
                 [](std::uint64_t sum) { return sum != 0; });
  return maybe;
}

const VertexClouds& vertex_clouds() {
  static const void* const clouds = module_symbol("registration_pcl");
  return *static_cast<const VertexClouds*>(clouds);
}

}  // namespace

RegistrationTarget::Impl::Impl(const TriangleMesh& surface, TargetUse use, double standoff_mm)
    : Impl(surface, local_frame(bounding_box(checked(surface))), use, standoff_mm) {}

RegistrationTarget::Impl::Impl(const TriangleMesh& surface, const LocalFrame& frame, TargetUse use,
                               double standoff_mm)
    : centre(frame.centre),
      scale(frame.scale),
      // The points of a single use are too few to pay for a better tree.
      tree({.vertices = frame.to_local(surface.vertices), .triangles = surface.triangles},
           use == TargetUse::often ? TreeBuild::thorough : TreeBuild::quick),
      diagonal(bounding_diagonal(tree.mesh())),
      standoff(standoff_mm * frame.scale) {
  if (use == TargetUse::often) (void)grid();
  find_border();
}

RegistrationTarget::Impl::~Impl() = default;

void RegistrationTarget::Impl::find_border() {
  const TriangleMesh& mesh = tree.mesh();
  border_sides_.assign(static_cast<size_t>(mesh.triangles.size()), false);
  border_vertices_.assign(static_cast<size_t>(mesh.vertices.cols()), false);
  // A side on the border has both ends on it: only triangles with two such vertices are sorted.
  const std::vector<bool> maybe = maybe_on_border(mesh);
  std::vector<bool> use(static_cast<size_t>(mesh.triangles.cols()));
  for (size_t t = 0; t < use.size(); ++t) {
    const auto corners = mesh.triangles.col(static_cast<Eigen::Index>(t));
    use[t] = std::count_if(corners.begin(), corners.end(),
                           [&](int vertex) { return maybe[static_cast<size_t>(vertex)]; }) >= 2;
  }
  for_each_edge(sort_sides(mesh.triangles, use), [&](std::span<const EdgeSide> sides) {
    const auto low = static_cast<size_t>(sides[0].low), high = static_cast<size_t>(sides[0].high);
    if (sides.size() != 1 || !maybe[low] || !maybe[high]) return;
    border_sides_[static_cast<size_t>(sides[0].half_edge)] = true;
    border_vertices_[low] = true;
    border_vertices_[high] = true;
  });
}

bool RegistrationTarget::Impl::is_on_border(const SurfacePoint& foot) const {
  for (int k = 0; k < 3; ++k) {
    if (foot.barycentric[(k + 2) % 3] > 0) continue;
    if (border_sides_[static_cast<size_t>(3 * foot.triangle + k)]) return true;
    // At a corner of this side the border may belong to other triangles.
    for (const int corner : {k, (k + 1) % 3}) {
      if (foot.barycentric[corner] == 1 &&
          border_vertices_[static_cast<size_t>(tree.mesh().triangles(corner, foot.triangle))]) {
        return true;
      }
    }
  }
  return false;
}

Pairing RegistrationTarget::Impl::pair(const Eigen::Matrix3Xd& points) const {
  const WorkSteps::Progress nobody;
  WorkSteps steps(nobody, 1);
  return pair(points, steps);
}

Pairing RegistrationTarget::Impl::pair(const Eigen::Matrix3Xd& points, WorkSteps& steps) const {
  TrackedPairing tracked;
  pair(points, 0, tracked, steps);
  return std::move(tracked.pairing);
}

Nearest RegistrationTarget::Impl::search(const Eigen::Vector3d& point, int guess, double slack,
                                         TrackedTriangle& tracked) const {
  const LoneNearest found =
      point.allFinite() ? tree.lone_nearest(point, guess, slack) : LoneNearest{};
  tracked.searched_at = point;
  tracked.others = found.others;
  tracked.triangle = found.nearest.triangle;
  tracked.place = found.nearest.place;
  if (tracked.place >= 0) tracked.corners = tree.local_corners(tracked.place);
  return found.nearest.at;
}

void RegistrationTarget::Impl::pair(const Eigen::Matrix3Xd& points, double slack,
                                    TrackedPairing& tracked, WorkSteps& steps) const {
  Pairing& pairing = tracked.pairing;
  if (tracked.triangles.empty()) {
    pairing.resize(points.cols());
    tracked.triangles.resize(static_cast<std::size_t>(points.cols()));
  }
  const auto pair_range = [&](Eigen::Index begin, Eigen::Index end) {
    int guess = -1;  // neighbours in the order of the points are near
    for (Eigen::Index i = begin; i < end; ++i) {
      TrackedTriangle& known = tracked.triangles[static_cast<std::size_t>(i)];
      const Eigen::Vector3d point = tree.to_local(points.col(i));
      Nearest nearest;
      bool stays = false;
      if (known.triangle >= 0) {
        nearest = nearest_on_triangle(point, known.corners);
        const double moved = (point - known.searched_at).norm();
        stays = std::sqrt(nearest.squared_distance) + moved < known.others;
        guess = known.place;
      }
      if (!stays) {
        nearest = search(point, guess, slack * tree.scale(), known);
        if (known.triangle >= 0) pairing.normals.col(i) = unit_normal(known.corners);
      }
      guess = known.place;
      if (known.triangle < 0) {  // so far away that the distance overflows
        pairing.distances[i] = kInfinity;
        pairing.usable[i] = false;
        continue;
      }
      Eigen::Vector3d normal = pairing.normals.col(i);
      if (standoff > 0) normal = unit_normal(known.corners);
      const Eigen::Vector3d way = point - point_on(known.corners, nearest.barycentric);
      double height = normal.dot(way);
      double distance = std::sqrt(nearest.squared_distance);
      if (standoff > 0) {
        const double side = height < 0 ? -1 : 1;
        if (distance > 0) normal = side / distance * way;
        pairing.normals.col(i) = normal;
        height = side * distance - standoff * tree.scale();
        distance = std::abs(height);
      }
      pairing.heights[i] = height / tree.scale();
      pairing.distances[i] = distance / tree.scale();
      pairing.usable[i] = normal.allFinite() && !is_on_border({.triangle = known.triangle,
                                                               .barycentric = nearest.barycentric});
    }
  };
  for (Eigen::Index first = 0; first < points.cols(); first += kPointsPerReport) {
    parallel_ranges(
        std::min(kPointsPerReport, points.cols() - first), kPointsPerTask,
        [&](Eigen::Index begin, Eigen::Index end) { pair_range(first + begin, first + end); });
    steps.tell(0);
  }
}

void RegistrationTarget::Impl::pair_coarsely(const Eigen::Matrix3Xd& points,
                                             Pairing& pairing) const {
  const SurfelGrid& map = grid();
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Surfel& surfel = map.nearest(points.col(i));
    const Eigen::Vector3d foot = surfel.position.cast<double>();
    const Eigen::Vector3d normal = surfel.normal.cast<double>();
    const Eigen::Vector3d way = points.col(i) - foot;
    const double above = normal.dot(way);
    const double height = above - standoff;
    const double distance = std::abs((above < 0 ? -1 : 1) * way.norm() - standoff);
    const bool is_far = distance > 2 * map.cell_size();
    pairing.normals.col(i) = normal;
    pairing.heights[i] = height;
    // At close range the surfel's plane approximates the surface better than its centre.
    pairing.distances[i] = is_far ? distance : std::abs(height);
    pairing.usable[i] = !is_far || std::abs(height) > kAlongNormal * distance;
  }
}

const SurfelGrid& RegistrationTarget::Impl::grid() const {
  std::call_once(grid_made_, [this] { grid_.emplace(tree.mesh()); });
  return *grid_;
}

const VertexCloud& RegistrationTarget::Impl::vertex_cloud() const {
  std::call_once(cloud_made_, [this] {
    const TriangleMesh used = compact(tree.mesh()).mesh;
    const Eigen::Matrix3Xd normals = vertex_normals(used);
    cloud_ = vertex_clouds().create(used.vertices + standoff * normals, normals);
  });
  return *cloud_;
}

Eigen::Isometry3d RegistrationTarget::Impl::to_world(const Eigen::Isometry3d& local) const {
  Eigen::Isometry3d world = local;
  world.translation() = centre + local.translation() / scale - local.linear() * centre;
  return world;
}

RegistrationTarget::RegistrationTarget(const TriangleMesh& mesh, double standoff) {
  require("RegistrationTarget: standoff", standoff, at_least(0).finite(), "mm");
  impl_ = std::make_shared<const Impl>(mesh, TargetUse::often, standoff);
}

}  // namespace palpate::geometry
