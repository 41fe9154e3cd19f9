// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/decimation.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "mesh/edge_table.h"
#include "palpate/error.h"
#include "palpate/require.h"
#include "query/decimation_check.h"
#include "query/local_frame.h"

namespace palpate::geometry {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The error allowed to meshoptimizer, as fractions of the tolerance: what it begins with, and how
/// far it rises. Its own estimate is a half to a third of the distance, but only where that is
/// largest. What is held fast because a large error fits it badly then is as coarse as a smaller
/// one left it.
constexpr double kFirstError = 0.2;
constexpr double kLastError = 0.7;

/// What it is multiplied by when a mesh passes, and when none does.
constexpr double kGrow = 2;
constexpr double kShrink = 0.6;

/// Of the tolerance: below it the search ends.
constexpr double kLeastError = 0.02;

/// How often the unfit parts of a mesh are held fast before its error is given up; also as soon as
/// they are no nearer to none than kPatience times before. The first time does not count: around
/// what is held fast new ones arise, of each of the three kinds.
constexpr std::size_t kMostRounds = 24;
constexpr std::size_t kPatience = 6;

/// No new error is tried after so many meshes.
constexpr int kMostTries = 40;

/// A mesh is worth going on with iff it has at least this fraction fewer triangles.
constexpr double kLeastGain = 0.03;

/// A mesh with vertices that meshoptimizer is not to move.
struct Draft {
  TriangleMesh mesh;  ///< with all vertices of the input
  std::vector<char> fixed;
  Eigen::Matrix3Xi neighbours;

  explicit Draft(TriangleMesh start)
      : mesh(std::move(start)),
        fixed(static_cast<std::size_t>(mesh.vertices.cols()), 0),
        neighbours(triangle_neighbours(mesh.triangles)) {}
};

/// Positions as meshoptimizer takes them: centred, scaled by a power of two to [-1, 1], float.
struct FloatPositions {
  Eigen::Matrix3Xf local;
  double scale;  ///< local = scale * (world - centre)

  explicit FloatPositions(const TriangleMesh& mesh) {
    const LocalFrame frame = local_frame(mesh.vertices);
    scale = frame.scale;
    local = frame.to_local(mesh.vertices).cast<float>();
  }
};

/// No error at all for meshoptimizer, which squares it in float.
constexpr double kMostRelativeError = 1e6;

/// One run of meshoptimizer: `error` in mm by its own estimate.
TriangleMesh simplify(const Draft& draft, FloatPositions positions, double error,
                      Eigen::Index target_triangles) {
  const Eigen::Index count = draft.mesh.vertices.cols();
  // It never moves a vertex that two more have the place of: a corner of several surfaces.
  const auto fixed =
      static_cast<Eigen::Index>(std::count(draft.fixed.begin(), draft.fixed.end(), 1));
  Eigen::Matrix3Xf& local = positions.local;
  local.conservativeResize(3, count + 2 * fixed);
  Eigen::Index next = count;
  for (Eigen::Index v = 0; v < count; ++v) {
    if (draft.fixed[static_cast<std::size_t>(v)] == 0) continue;
    local.col(next++) = local.col(v);
    local.col(next++) = local.col(v);
  }
  const std::vector<unsigned> indices(draft.mesh.triangles.data(),
                                      draft.mesh.triangles.data() + draft.mesh.triangles.size());
  std::vector<unsigned> simplified(indices.size());
  const auto vertex_count = static_cast<std::size_t>(local.cols());
  constexpr std::size_t kStride = 3 * sizeof(float);
  const double relative =
      error * positions.scale /
      static_cast<double>(meshopt_simplifyScale(local.data(), vertex_count, kStride));
  simplified.resize(
      meshopt_simplify(simplified.data(), indices.data(), indices.size(), local.data(),
                       vertex_count, kStride, static_cast<std::size_t>(3 * target_triangles),
                       static_cast<float>(std::min(relative, kMostRelativeError)), 0, nullptr));
  TriangleMesh mesh;
  mesh.vertices = draft.mesh.vertices;
  mesh.triangles.resize(3, static_cast<Eigen::Index>(simplified.size() / 3));
  std::copy(simplified.begin(), simplified.end(), mesh.triangles.data());
  return mesh;
}

/// Fixes what of the draft is around the corners of the unfit triangles of its candidate and where
/// points of the input were lost, and all that lies under those that are too far away.
void fix_below(Draft& draft, const TriangleMesh& candidate, const DistanceTarget& target,
               const Unfit& unfit) {
  std::vector<char> is_far(static_cast<std::size_t>(candidate.triangles.cols()), 0);
  std::vector<char> at_corner(draft.fixed.size(), 0);
  for (const int t : unfit.far) is_far[static_cast<std::size_t>(t)] = 1;
  for (const std::vector<int>* triangles : {&unfit.far, &unfit.shapes}) {
    for (const int t : *triangles) {
      for (const int v : candidate.triangles.col(t)) at_corner[static_cast<std::size_t>(v)] = 1;
    }
  }
  std::vector<int> todo;
  // Of what was folded, nothing of the candidate need be left nearby.
  if (!unfit.lost.empty()) {
    const SurfaceQuery draft_query(draft.mesh);
    for (const Eigen::Vector3d& point : unfit.lost) {
      const int t = draft_query.closest_point(point).at.triangle;
      for (const int v : draft.mesh.triangles.col(t)) at_corner[static_cast<std::size_t>(v)] = 1;
    }
  }
  std::vector<char> seen(static_cast<std::size_t>(draft.mesh.triangles.cols()), 0);
  const auto visit = [&](int t) {
    if (t < 0 || seen[static_cast<std::size_t>(t)] != 0) return;
    seen[static_cast<std::size_t>(t)] = 1;
    todo.push_back(t);
  };
  for (int t = 0; t < static_cast<int>(seen.size()); ++t) {
    for (const int v : draft.mesh.triangles.col(t)) {
      if (at_corner[static_cast<std::size_t>(v)] != 0) visit(t);
    }
  }
  // All around the corners: of a sliver nothing else may lie below it.
  for (const int t : todo) {
    for (const int v : draft.mesh.triangles.col(t)) draft.fixed[static_cast<std::size_t>(v)] = 1;
  }
  while (!todo.empty()) {
    const int t = todo.back();
    todo.pop_back();
    const SurfacePoint centre{.triangle = t, .barycentric = Eigen::Vector3d::Constant(1.0 / 3)};
    const int above = target.query.closest_point(position(draft.mesh, centre)).at.triangle;
    if (above < 0 || is_far[static_cast<std::size_t>(above)] == 0) continue;
    for (const int v : draft.mesh.triangles.col(t)) draft.fixed[static_cast<std::size_t>(v)] = 1;
    for (const int neighbour : draft.neighbours.col(t)) visit(neighbour);
  }
}

/// What a mesh made from another one is to be.
struct Aim {
  double error;                   ///< [mm] by meshoptimizer's estimate
  double tolerance;               ///< [mm]
  Eigen::Index target_triangles;  ///< it stops there
  double gain;                    ///< the fraction of the triangles to go at least
};

/// A mesh made from `draft` that passes; none if too little is gained, also because parts of it
/// that do not fit are held fast.
std::optional<TriangleMesh> pass(Draft draft, const FloatPositions& positions, const Aim& aim,
                                 const DecimationStandard& standard, KnownNear& known, int& tries) {
  const double most = (1 - aim.gain) * static_cast<double>(draft.mesh.triangles.cols());
  std::vector<std::pair<int, std::size_t>> left;
  while (left.size() < kMostRounds) {
    TriangleMesh candidate = simplify(draft, positions, aim.error, aim.target_triangles);
    mend_slivers(candidate, draft.fixed);
    ++tries;
    const auto count = static_cast<double>(candidate.triangles.cols());
    if (count == 0 || count > most) return std::nullopt;
    const DistanceTarget target(candidate);
    const Unfit unfit = find_unfit(candidate, target, standard, aim.tolerance, known);
    if (unfit.count() == 0) return candidate;
    left.push_back(unfit.left());
    const std::size_t rounds = left.size();
    if (rounds > kPatience + 1 && left[rounds - 1] >= left[rounds - 1 - kPatience]) {
      return std::nullopt;
    }
    fix_below(draft, candidate, target, unfit);
  }
  return std::nullopt;
}

/// Without the vertices that no triangle uses.
Decimation compact(const TriangleMesh& mesh) {
  std::vector<int> index(static_cast<std::size_t>(mesh.vertices.cols()), -1);
  for (const int v : mesh.triangles.reshaped()) index[static_cast<std::size_t>(v)] = 0;
  Decimation result;
  for (std::size_t v = 0; v < index.size(); ++v) {
    if (index[v] < 0) continue;
    index[v] = static_cast<int>(result.vertex.size());
    result.vertex.push_back(static_cast<int>(v));
  }
  result.mesh.vertices = mesh.vertices(Eigen::all, result.vertex);
  result.mesh.triangles =
      mesh.triangles.unaryExpr([&index](int v) { return index[static_cast<std::size_t>(v)]; });
  return result;
}

void check(const DecimationOptions& options) {
  require("DecimationOptions::tolerance", options.tolerance, above(0).finite(), "mm");
  require("DecimationOptions::max_triangles", options.max_triangles, at_least(1));
  if (options.tolerance.has_value() == options.max_triangles.has_value()) {
    throw InvalidInput(
        fmt::format("DecimationOptions: {} given; give either the tolerance [mm] or max_triangles",
                    options.tolerance ? "both tolerance and max_triangles are" : "no limit is"));
  }
}

/// The smallest mesh found that keeps the tolerance. Each is made from the last one that did, not
/// from the input: parts held fast then are as coarse as they were.
TriangleMesh to_tolerance(const TriangleMesh& mesh, const DecimationStandard& standard,
                          double tolerance, int& tries) {
  const FloatPositions positions(mesh);
  KnownNear known{.near = standard.triangles};
  TriangleMesh best = mesh;
  double error = kFirstError * tolerance;
  double grow = kGrow;
  while (tries < kMostTries && error >= kLeastError * tolerance) {
    const Aim aim{
        .error = error, .tolerance = tolerance, .target_triangles = 0, .gain = kLeastGain};
    std::optional<TriangleMesh> smaller = pass(Draft(best), positions, aim, standard, known, tries);
    if (smaller) best = std::move(*smaller);
    // Too little to gain as well: a larger error may do more.
    const bool rise = grow > 1 && error < kLastError * tolerance;
    if (smaller || rise) {
      error = std::min(error * grow, kLastError * tolerance);
    }
    if (!smaller && !rise) {
      grow = 1;
      error *= kShrink;
    }
  }
  return best;
}

/// A mesh of at most `max_triangles`, or as near to that as one passes.
TriangleMesh to_count(const TriangleMesh& mesh, const DecimationStandard& standard,
                      int max_triangles, int& tries) {
  const FloatPositions positions(mesh);
  KnownNear known{.near = standard.triangles};
  TriangleMesh best = mesh;
  const Aim aim{
      .error = kInfinity, .tolerance = kInfinity, .target_triangles = max_triangles, .gain = 0};
  while (tries < kMostTries && best.triangles.cols() > max_triangles) {
    std::optional<TriangleMesh> smaller = pass(Draft(best), positions, aim, standard, known, tries);
    if (!smaller || smaller->triangles.cols() == best.triangles.cols()) break;
    best = std::move(*smaller);
  }
  return best;
}

}  // namespace

Decimation decimate(const TriangleMesh& mesh, const DecimationOptions& options) {
  check(options);
  check_mesh(mesh, "decimate(): mesh");
  const DecimationStandard standard(mesh);
  int tries = 0;
  const TriangleMesh best = options.tolerance
                                ? to_tolerance(mesh, standard, *options.tolerance, tries)
                                : to_count(mesh, standard, *options.max_triangles, tries);
  if (best.triangles.cols() == mesh.triangles.cols()) {
    Decimation same{.mesh = mesh, .vertex = {}, .distance = 0, .tries = tries};
    same.vertex.resize(static_cast<std::size_t>(mesh.vertices.cols()));
    std::iota(same.vertex.begin(), same.vertex.end(), 0);
    return same;
  }
  Decimation result = compact(best);
  result.tries = tries;
  const HausdorffDistance distance = hausdorff_distance(mesh, result.mesh);
  // Both bounds hold; that by which the mesh passed may be the tighter one.
  result.distance =
      options.tolerance ? std::min(distance.upper, *options.tolerance) : distance.upper;
  return result;
}

}  // namespace palpate::geometry
