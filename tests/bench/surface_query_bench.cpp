// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Closest points, first and all hits of rays and segments, one by one on one thread, against Embree
// used directly in single precision and against CGAL's tree; moving the vertices against Embree.
#include "palpate/geometry/surface_query.h"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "mesh_corpus.h"
#include "paired.h"
#include "surface_query_peers.h"

namespace {

using Eigen::Vector3d;
using palpate::bench::CgalPeer;
using palpate::bench::EmbreePeer;
using palpate::geometry::SurfaceQuery;
using palpate::geometry::TriangleMesh;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr int kQueries = 20000;

TriangleMesh mesh_number(std::int64_t number) {
  return number == 0 ? palpate::geometry::test::bumpy(300'000, 0.25)
                     : palpate::geometry::test::glove(0.9);
}

struct Line {
  Vector3d origin, along;
};

/// Coherent: from one place before the mesh to a grid over its bounding box, as a camera looks.
/// Incoherent: between places at random in the doubled bounding box.
std::vector<Line> make_lines(const TriangleMesh& mesh, bool coherent) {
  const Vector3d lower = mesh.vertices.rowwise().minCoeff();
  const Vector3d size = mesh.vertices.rowwise().maxCoeff() - lower;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-0.5, 1.5);
  const auto anywhere = [&] {
    return Vector3d(lower +
                    Vector3d{uniform(random), uniform(random), uniform(random)}.cwiseProduct(size));
  };
  const auto side = static_cast<int>(std::sqrt(kQueries));
  const Vector3d eye = lower + Vector3d(0.4, 0.6, -5).cwiseProduct(size);
  std::vector<Line> lines;
  for (int i = 0; i < kQueries; ++i) {
    const Vector3d pixel(0.0013 + (i % side) / (side - 1.0), 0.0017 + i / side / (side - 1.0), 1);
    const Vector3d start = coherent ? eye : anywhere();
    const Vector3d end = coherent ? lower + pixel.cwiseProduct(size) : anywhere();
    lines.push_back({start, end - start});
  }
  return lines;
}

/// Coherent: near the surface, one triangle after the other, as a scan is compared with a mesh or
/// a tool slides. Incoherent: anywhere in the doubled bounding box.
std::vector<Vector3d> make_points(const TriangleMesh& mesh, bool coherent) {
  std::vector<Vector3d> points;
  if (!coherent) {
    for (const Line& line : make_lines(mesh, false)) points.push_back(line.origin);
    return points;
  }
  std::mt19937 random(2);
  const double spread = 0.005 * palpate::geometry::bounding_diagonal(mesh);
  std::normal_distribution<double> normal(0, spread);
  for (int i = 0; i < kQueries; ++i) {
    const auto t = static_cast<int>(mesh.triangles.cols() * i / kQueries);
    points.push_back(position(mesh, {.triangle = t, .barycentric = {0.2, 0.5, 0.3}}) +
                     Vector3d{normal(random), normal(random), normal(random)});
  }
  return points;
}

/// In single precision, coordinates of the size of the mesh's distance from the origin are off by
/// that times 6e-8; a few times that, relative to the mesh's size.
constexpr double kSinglePrecision = 1e-5;
/// Rays that meet the surface at its border or silhouette may hit in one precision and not in the
/// other.
constexpr double kMayDiffer = 2e-3;

void compare_answers(benchmark::State& state, const std::vector<double>& ours,
                     const std::vector<double>& peer, double tolerance) {
  int differ = 0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    const bool same =
        std::isnan(ours[i]) ? std::isnan(peer[i]) : std::abs(ours[i] - peer[i]) <= tolerance;
    if (!same) ++differ;
  }
  state.counters["differ"] = differ;
  if (differ > kMayDiffer * static_cast<double>(ours.size())) {
    state.SkipWithError("answers differ; fix that before comparing speed");
  }
}

template <class Peer>
void closest_point_against(benchmark::State& state) {
  const TriangleMesh mesh = mesh_number(state.range(0));
  const std::vector<Vector3d> points = make_points(mesh, state.range(1) != 0);
  const SurfaceQuery query(mesh);
  const Peer peer(mesh);
  std::vector<double> our_answers(points.size()), peer_answers(points.size());
  palpate::bench::run_paired(
      state,
      [&] {
        for (std::size_t i = 0; i < points.size(); ++i) {
          our_answers[i] = query.closest_point(points[i]).distance;
        }
      },
      [&] {
        for (std::size_t i = 0; i < points.size(); ++i) {
          peer_answers[i] = peer.distance(points[i]);
        }
      });
  compare_answers(state, our_answers, peer_answers, kSinglePrecision * bounding_diagonal(mesh));
}

template <class Peer>
void first_hit_against(benchmark::State& state) {
  const TriangleMesh mesh = mesh_number(state.range(0));
  const std::vector<Line> lines = make_lines(mesh, state.range(1) != 0);
  const bool segments = state.range(2) != 0;
  const float far = segments ? 1 : std::numeric_limits<float>::infinity();
  const SurfaceQuery query(mesh);
  const Peer peer(mesh);
  std::vector<double> our_answers(lines.size()), peer_answers(lines.size());
  palpate::bench::run_paired(
      state,
      [&] {
        for (std::size_t i = 0; i < lines.size(); ++i) {
          const auto& [from, along] = lines[i];
          if (segments) {
            const auto hit = query.first_hit(from, from + along);
            our_answers[i] = hit ? hit->fraction : kNan;
          } else {
            const auto hit = query.first_hit({.origin = from, .direction = along});
            our_answers[i] = hit ? hit->distance : kNan;
          }
        }
      },
      [&] {
        for (std::size_t i = 0; i < lines.size(); ++i) {
          peer_answers[i] = peer.first_crossing(lines[i].origin, lines[i].along, far);
        }
      });
  if (!segments) {
    for (std::size_t i = 0; i < lines.size(); ++i) our_answers[i] /= lines[i].along.norm();
  }
  compare_answers(state, our_answers, peer_answers, kSinglePrecision);
}

/// Rays cross the surface a few dozen times at most.
constexpr double kSumPrecision = 50 * kSinglePrecision;

/// All crossings of a ray, whose numbers and sums are compared.
void all_hits_against_embree(benchmark::State& state) {
  const TriangleMesh mesh = mesh_number(state.range(0));
  const std::vector<Line> lines = make_lines(mesh, state.range(1) != 0);
  const SurfaceQuery query(mesh);
  const EmbreePeer peer(mesh, EmbreePeer::Purpose::all_hits);
  std::vector<double> our_answers(lines.size()), peer_answers(lines.size());
  double crossings = 0;
  palpate::bench::run_paired(
      state,
      [&] {
        crossings = 0;
        for (std::size_t i = 0; i < lines.size(); ++i) {
          const auto& [from, along] = lines[i];
          const auto hits =
              query.all_hits(palpate::geometry::Ray{.origin = from, .direction = along});
          our_answers[i] = 0;
          for (const auto& hit : hits) our_answers[i] += 1 + hit.distance / along.norm();
          crossings += static_cast<double>(hits.size());
        }
      },
      [&] {
        for (std::size_t i = 0; i < lines.size(); ++i) {
          peer_answers[i] = 0;
          for (const double t : peer.all_crossings(lines[i].origin, lines[i].along)) {
            peer_answers[i] += 1 + t;
          }
        }
      });
  compare_answers(state, our_answers, peer_answers, kSumPrecision);
  state.counters["crossings"] = crossings / static_cast<double>(lines.size());
}
BENCHMARK(all_hits_against_embree)
    ->ArgNames({"mesh", "coherent"})
    ->ArgsProduct({{0, 1}, {0, 1}})
    ->Unit(benchmark::kMillisecond);

/// The mesh bends and straightens: both fit the boxes again.
void move_vertices_against_embree(benchmark::State& state) {
  const TriangleMesh mesh = mesh_number(state.range(0));
  Eigen::Matrix3Xd bent = mesh.vertices;
  const double size = palpate::geometry::bounding_diagonal(mesh);
  for (auto v : bent.colwise()) v.z() += 0.05 * size * std::sin(10 * v.x() / size);
  SurfaceQuery query(mesh);
  EmbreePeer peer(mesh, EmbreePeer::Purpose::moves);
  bool ours_bent = false, peer_bent = false;
  palpate::bench::run_paired(
      state,
      [&] {
        ours_bent = !ours_bent;
        query.move_vertices(ours_bent ? bent : mesh.vertices);
      },
      [&] {
        peer_bent = !peer_bent;
        peer.move(peer_bent ? bent : mesh.vertices);
      });
  query.move_vertices(bent);
  peer.move(bent);
  const SurfaceQuery rebuilt({.vertices = bent, .triangles = mesh.triangles});
  const std::vector<Vector3d> points = make_points(mesh, true);
  std::vector<double> our_answers(points.size()), peer_answers(points.size()),
      rebuilt_answers(points.size());
  const double rebuilding = palpate::bench::seconds(
      [&] { SurfaceQuery({.vertices = bent, .triangles = mesh.triangles}); });
  const double fitted = palpate::bench::seconds([&] {
    for (std::size_t i = 0; i < points.size(); ++i) {
      our_answers[i] = query.closest_point(points[i]).distance;
    }
  });
  const double anew = palpate::bench::seconds([&] {
    for (std::size_t i = 0; i < points.size(); ++i) {
      rebuilt_answers[i] = rebuilt.closest_point(points[i]).distance;
    }
  });
  for (std::size_t i = 0; i < points.size(); ++i) peer_answers[i] = peer.distance(points[i]);
  if (our_answers != rebuilt_answers) state.SkipWithError("fitted and built anew differ");
  compare_answers(state, our_answers, peer_answers, kSinglePrecision * size);
  state.counters["rebuilding_ms"] = 1e3 * rebuilding;
  state.counters["query fitted/rebuilt"] = fitted / anew;
}
BENCHMARK(move_vertices_against_embree)
    ->ArgName("mesh")
    ->Arg(0)
    ->Arg(1)
    ->Unit(benchmark::kMillisecond);

BENCHMARK(closest_point_against<EmbreePeer>)
    ->ArgNames({"mesh", "coherent"})
    ->ArgsProduct({{0, 1}, {0, 1}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(closest_point_against<CgalPeer>)
    ->ArgNames({"mesh", "coherent"})
    ->ArgsProduct({{0, 1}, {0, 1}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(first_hit_against<EmbreePeer>)
    ->ArgNames({"mesh", "coherent", "segment"})
    ->ArgsProduct({{0, 1}, {0, 1}, {0, 1}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(first_hit_against<CgalPeer>)
    ->ArgNames({"mesh", "coherent", "segment"})
    ->ArgsProduct({{0, 1}, {0, 1}, {0, 1}})
    ->Unit(benchmark::kMillisecond);

}  // namespace
