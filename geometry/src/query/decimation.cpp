// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/decimation.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "base/numbers.h"
#include "mesh/compact_mesh.h"
#include "mesh/edge_table.h"
#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "query/decimation_check.h"
#include "query/local_frame.h"
#include "query/texture_seams.h"

namespace palpate::geometry {
namespace {

/// Error allowed to meshoptimizer as a fraction of the tolerance: initial value and maximum. Its
/// own estimate is a half to a third of the distance, but only where the distance is largest. Parts
/// that are fixed because a large error does not fit there stay as coarse as a smaller error left
/// them.
constexpr double kFirstError = 0.2;
constexpr double kLastError = 0.7;

/// Factors of the error after a mesh passes, and after none does.
constexpr double kGrow = 2;
constexpr double kShrink = 0.6;

/// The search ends when the error falls below this fraction of the tolerance.
constexpr double kLeastError = 0.02;

/// An error is given up after fixing the unfit parts of a mesh this many times, or after kPatience
/// rounds in which the check that failed found no fewer than ever before. Each check is compared
/// with itself, because new unfit parts of all kinds arise around those that are fixed.
constexpr int kMostRounds = 24;
constexpr int kPatience = 6;

/// No new error is tried after this many meshes.
constexpr int kMostTries = 60;

/// A mesh is a useful intermediate result iff it has at least this fraction fewer triangles.
constexpr double kLeastGain = 0.03;

/// Positions as meshoptimizer takes them: centred, scaled by a power of two to [-1, 1], float.
struct FloatPositions {
  Eigen::Matrix3Xf local;
  double scale;  ///< local = scale * (world - centre)
  /// The vertices with the lowest and the highest coordinates: meshoptimizer rounds relative to the
  /// extent, which must not depend on the vertices that are still used.
  std::array<int, 6> extreme{};

  explicit FloatPositions(const TriangleMesh& mesh) {
    const LocalFrame frame = local_frame(bounding_box(mesh));
    scale = frame.scale;
    local = frame.to_local(mesh.vertices).cast<float>();
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const auto place = static_cast<std::size_t>(2 * axis);
      local.row(axis).minCoeff(&extreme[place]);
      local.row(axis).maxCoeff(&extreme[place + 1]);
    }
  }
};

/// A mesh with vertices that meshoptimizer must not move.
struct Draft {
  TriangleMesh mesh;  ///< with all vertices of the input
  std::vector<char> fixed;
  CompactMesh used;  ///< without vertices that meshoptimizer does not need
  Eigen::Matrix3Xi neighbours;
  std::optional<SurfaceQuery> query;  ///< built when it is needed first

  Draft(TriangleMesh start, const FloatPositions& positions)
      : mesh(std::move(start)),
        fixed(static_cast<std::size_t>(mesh.vertices.cols()), 0),
        used(compact(mesh, positions.extreme)),
        neighbours(triangle_neighbours(mesh.triangles)) {}
};

/// Upper limit of the relative error, because meshoptimizer squares it in float.
constexpr double kMostRelativeError = 1e6;

/// One run of meshoptimizer: `error` in mm by its own estimate.
TriangleMesh simplify(const Draft& draft, const FloatPositions& positions, double error,
                      Eigen::Index target_triangles) {
  const std::vector<int>& source = draft.used.source;
  const auto is_fixed = [&](int v) { return draft.fixed[static_cast<std::size_t>(v)] != 0; };
  const auto fixed = static_cast<Eigen::Index>(std::ranges::count_if(source, is_fixed));
  // Two copies of each fixed vertex are added, because meshoptimizer never moves a vertex that
  // coincides with two others: it takes it for a corner of several surfaces.
  const auto count = static_cast<Eigen::Index>(source.size());
  Eigen::Matrix3Xf local(3, count + 2 * fixed);
  local.leftCols(count) = positions.local(Eigen::all, source);
  Eigen::Index next = count;
  for (Eigen::Index v = 0; v < count; ++v) {
    if (!is_fixed(source[static_cast<std::size_t>(v)])) continue;
    local.col(next++) = local.col(v);
    local.col(next++) = local.col(v);
  }
  const Eigen::Matrix3Xi& triangles = draft.used.mesh.triangles;
  const std::vector<unsigned> indices(triangles.data(), triangles.data() + triangles.size());
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
  std::ranges::transform(simplified, mesh.triangles.data(), [&](unsigned v) { return source[v]; });
  return mesh;
}

/// Fixes the parts of the draft around the corners of unfit triangles and around lost points of the
/// input, and everything below triangles that are too far away.
void fix_below(Draft& draft, Candidate& candidate, const Unfit& unfit) {
  const Eigen::Matrix3Xi& triangles = candidate.mesh().triangles;
  std::vector<char> is_far(static_cast<std::size_t>(triangles.cols()), 0);
  std::vector<char> at_corner(draft.fixed.size(), 0);
  for (const int t : unfit.far) is_far[static_cast<std::size_t>(t)] = 1;
  for (const std::vector<int>* found : {&unfit.far, &unfit.shapes}) {
    for (const int t : *found) {
      for (const int v : triangles.col(t)) at_corner[static_cast<std::size_t>(v)] = 1;
    }
  }
  std::vector<int> todo;
  // Where the surface was folded, the candidate may have nothing left nearby.
  if (!unfit.lost.empty()) {
    if (!draft.query) draft.query.emplace(draft.used.mesh);
    for (const Eigen::Vector3d& point : unfit.lost) {
      const int t = draft.query->closest_point(point).at.triangle;
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
  // Include all triangles around the corners, since a sliver may have nothing else below it.
  for (const int t : todo) {
    for (const int v : draft.mesh.triangles.col(t)) draft.fixed[static_cast<std::size_t>(v)] = 1;
  }
  if (unfit.far.empty()) return;
  while (!todo.empty()) {
    const int t = todo.back();
    todo.pop_back();
    const SurfacePoint centre{.triangle = t, .barycentric = Eigen::Vector3d::Constant(1.0 / 3)};
    const int above =
        candidate.target().query.closest_point(position(draft.mesh, centre)).at.triangle;
    if (above < 0 || is_far[static_cast<std::size_t>(above)] == 0) continue;
    for (const int v : draft.mesh.triangles.col(t)) draft.fixed[static_cast<std::size_t>(v)] = 1;
    for (const int neighbour : draft.neighbours.col(t)) visit(neighbour);
  }
}

/// Requirements of a mesh to be made from another one.
struct Aim {
  double error;                   ///< [mm] by meshoptimizer's estimate
  double tolerance;               ///< [mm]
  Eigen::Index target_triangles;  ///< stop at this count
  double gain;                    ///< smallest fraction of the triangles to be removed
};

/// Number of meshes made and checked.
class Tries {
 public:
  explicit Tries(const std::function<void(int done, int total)>& progress) : progress_(progress) {}
  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] bool may_begin() const { return count_ < kMostTries; }
  void add() {
    ++count_;
    if (progress_) progress_(std::min(count_, kMostTries), kMostTries + 1);
  }
  void end() const {
    if (progress_) progress_(kMostTries + 1, kMostTries + 1);
  }

 private:
  const std::function<void(int done, int total)>& progress_;
  int count_ = 0;
};

/// Makes a mesh from `draft` that passes; none if too little is gained, for example because unfit
/// parts of it are fixed.
std::optional<TriangleMesh> pass(Draft draft, const FloatPositions& positions, const Aim& aim,
                                 const DecimationStandard& standard, KnownTriangles& known,
                                 Tries& tries) {
  const double most = (1 - aim.gain) * static_cast<double>(draft.mesh.triangles.cols());
  std::map<Unfit::Check, std::size_t> fewest;
  int in_vain = 0;
  for (int round = 0; round < kMostRounds && in_vain < kPatience; ++round) {
    TriangleMesh mesh = simplify(draft, positions, aim.error, aim.target_triangles);
    mend_slivers(mesh, draft.fixed, standard.at_seam);
    tries.add();
    const auto count = static_cast<double>(mesh.triangles.cols());
    if (count == 0 || count > most) return std::nullopt;
    Candidate candidate(std::move(mesh));
    const Unfit unfit = find_unfit(candidate, standard, aim.tolerance, known);
    if (unfit.count() == 0) return candidate.mesh();
    const auto [known_fewest, is_first] = fewest.try_emplace(unfit.check(), unfit.count());
    in_vain = is_first || unfit.count() < known_fewest->second ? 0 : in_vain + 1;
    known_fewest->second = std::min(known_fewest->second, unfit.count());
    fix_below(draft, candidate, unfit);
  }
  return std::nullopt;
}

void check(const DecimationOptions& options) {
  static_cast<void>(in_range(options));
  if (options.tolerance.has_value() != options.max_triangles.has_value()) return;
  const MessagePart tolerance{"DecimationOptions::tolerance", true},
      count{"DecimationOptions::max_triangles", true};
  throw InvalidInput(std::vector<MessagePart>{
      {"give either "}, tolerance, {" or "}, count, {options.tolerance ? ", not both" : ""}});
}

/// Finds the smallest mesh within the tolerance. Each mesh is made from the last one that passed,
/// not from the input, so parts fixed at that time keep the coarseness they had.
TriangleMesh to_tolerance(const TriangleMesh& mesh, const DecimationStandard& standard,
                          double tolerance, Tries& tries) {
  const FloatPositions positions(mesh);
  KnownTriangles known(mesh);
  TriangleMesh best = mesh;
  double error = kFirstError * tolerance;
  double grow = kGrow;
  while (tries.may_begin() && error >= kLeastError * tolerance) {
    const Aim aim{
        .error = error, .tolerance = tolerance, .target_triangles = 0, .gain = kLeastGain};
    std::optional<TriangleMesh> smaller =
        pass(Draft(best, positions), positions, aim, standard, known, tries);
    if (smaller) best = std::move(*smaller);
    // If too little was gained, try a larger error as well.
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

/// Finds a mesh of at most `max_triangles`, or the closest to it that passes.
TriangleMesh to_count(const TriangleMesh& mesh, const DecimationStandard& standard,
                      int max_triangles, Tries& tries) {
  const FloatPositions positions(mesh);
  KnownTriangles known(mesh);
  TriangleMesh best = mesh;
  const Aim aim{
      .error = kInfinity, .tolerance = kInfinity, .target_triangles = max_triangles, .gain = 0};
  while (tries.may_begin() && best.triangles.cols() > max_triangles) {
    std::optional<TriangleMesh> smaller =
        pass(Draft(best, positions), positions, aim, standard, known, tries);
    if (!smaller || smaller->triangles.cols() == best.triangles.cols()) break;
    best = std::move(*smaller);
  }
  return best;
}

/// \param seamed the mesh if it has a texture, or null.
Decimation decimate_seamed(const TriangleMesh& mesh, const SeamedMesh* seamed,
                           const DecimationOptions& options) {
  const DecimationStandard standard(mesh, seamed);
  Tries tries(options.progress);
  const TriangleMesh best = options.tolerance
                                ? to_tolerance(mesh, standard, *options.tolerance, tries)
                                : to_count(mesh, standard, *options.max_triangles, tries);
  if (best.triangles.cols() == mesh.triangles.cols()) {
    Decimation same{.mesh = mesh, .source = {}, .distance = 0, .tries = tries.count()};
    same.source.resize(static_cast<std::size_t>(mesh.vertices.cols()));
    std::iota(same.source.begin(), same.source.end(), 0);
    tries.end();
    return same;
  }
  CompactMesh compacted = compact(best);
  Decimation result{.mesh = std::move(compacted.mesh),
                    .source = std::move(compacted.source),
                    .distance = 0,
                    .tries = tries.count()};
  const double distance =
      std::max(bound_largest_distance(mesh, DistanceTarget(result.mesh), {}).upper,
               bound_largest_distance(result.mesh, standard.input, {}).upper);
  // Both bounds hold; the one by which the mesh passed may be tighter.
  result.distance = options.tolerance ? std::min(distance, *options.tolerance) : distance;
  tries.end();
  return result;
}

/// Joins the vertices that were split at seams, and takes their places in the texture to the
/// corners.
TexturedDecimation join_seams(Decimation decimated, const SeamedMesh& seamed) {
  TexturedDecimation result;
  const Eigen::Matrix3Xi& triangles = decimated.mesh.triangles;
  result.texture.coordinates.resize(6, triangles.cols());
  result.texture.number.resize(triangles.cols());
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int split = decimated.source[static_cast<std::size_t>(triangles(k, t))];
      result.texture.coordinates.block<2, 1>(2 * k, t) = seamed.texture.col(split);
      result.texture.number[t] = seamed.number[static_cast<std::size_t>(split)];
    }
  }
  std::vector<int> joined, source;
  for (int v = 0; v < static_cast<int>(decimated.source.size()); ++v) {
    const int former =
        seamed.source[static_cast<std::size_t>(decimated.source[static_cast<std::size_t>(v)])];
    if (source.empty() || source.back() != former) {
      source.push_back(former);
    }
    joined.push_back(static_cast<int>(source.size()) - 1);
  }
  decimated.mesh.triangles =
      triangles.unaryExpr([&](int v) { return joined[static_cast<std::size_t>(v)]; }).eval();
  decimated.source = std::move(source);
  result.decimation = std::move(decimated);
  return result;
}

/// Moves a mesh to where points of its triangles are rounded least, without rounding it.
void move_near_origin(TriangleMesh& mesh) {
  mesh.vertices.colwise() -= exact_offset(bounding_box(mesh));
}

}  // namespace

void visit(DecimationOptions& options, FieldVisitor& visitor) {
  visitor.begin("DecimationOptions");
  visitor.real({"tolerance",
                "Remove triangles while the Hausdorff distance to the surface before this step is "
                "within this",
                "mm"},
               options.tolerance, above(0).finite());
  visitor.whole({"max_triangles",
                 "In place of tolerance: remove triangles until at most this number are left; more "
                 "stay if fewer would fold or tear the surface"},
                options.max_triangles, at_least(1));
}

Decimation decimate(const TriangleMesh& mesh, const DecimationOptions& options) {
  check(options);
  check_mesh(mesh, "decimate(): mesh");
  CompactMesh used = compact(mesh);
  move_near_origin(used.mesh);
  Decimation result = decimate_seamed(used.mesh, nullptr, options);
  for (int& v : result.source) v = used.source[static_cast<std::size_t>(v)];
  result.mesh.vertices = mesh.vertices(Eigen::all, result.source);
  return result;
}

TexturedDecimation decimate(const TriangleMesh& mesh, const CornerTexture& texture,
                            const DecimationOptions& options) {
  check(options);
  check_mesh(mesh, "decimate(): mesh");
  SeamedMesh seamed = split_at_seams(mesh, texture);
  move_near_origin(seamed.mesh);
  TexturedDecimation result = join_seams(decimate_seamed(seamed.mesh, &seamed, options), seamed);
  Decimation& decimation = result.decimation;
  decimation.mesh.vertices = mesh.vertices(Eigen::all, decimation.source);
  if (texture.number.size() == 0) result.texture.number.resize(0);
  return result;
}

}  // namespace palpate::geometry
