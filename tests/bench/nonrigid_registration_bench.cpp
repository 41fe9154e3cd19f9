// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Non-rigid registration of a surface of 1.5e5 vertices to a range map of 640 x 480, against ten
// steps of rigid registration (PCL's steps, exact closest points) of the same vertices to the mesh
// of the same map: dent of 20 mm, bend, noise, holes, and a tool in front.
#include "palpate/geometry/nonrigid_registration.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "mesh_corpus.h"
#include "paired.h"
#include "palpate/geometry/error_statistics.h"
#include "palpate/geometry/range_map_mesh.h"
#include "palpate/geometry/registration.h"
#include "range_map_scene.h"

namespace {

using Eigen::Vector3d;
using namespace palpate::geometry;

constexpr int kTriangles = 300000;
constexpr double kNoise = 0.25;  // mm, of the mesh (uniform) and of the map (normal)

enum Kind { block, plate };

/// The undeformed surface, where it truly goes, what is measured of it and which vertices are seen.
struct Scene {
  TriangleMesh rest;
  TriangleMesh moved;
  RangeMap map;
  std::vector<bool> visible;
};

Scene make_scene(Kind kind, double depth = 20) {
  Scene scene{.rest = test::bumpy(kTriangles, kNoise, 3), .moved = {}, .map = {}, .visible = {}};
  if (kind == plate) {
    for (Eigen::Index v = 0; v < scene.rest.vertices.cols(); ++v) {
      scene.rest.vertices.col(v) *= 700 / scene.rest.vertices(2, v);
    }
  }
  const auto move = [&](const Vector3d& p) { return test::bent(test::dented_block(p, depth)); };
  scene.moved = test::deformed(scene.rest, move);
  // The tip touches the vertex nearest to the middle of the dent.
  Eigen::Index touched = 0;
  (scene.rest.vertices.topRows<2>().colwise() - test::kDent.head<2>())
      .colwise()
      .squaredNorm()
      .minCoeff(&touched);
  const Vector3d tip = scene.moved.vertices.col(touched);
  const TriangleMesh all =
      test::together(scene.moved, test::rod(tip, tip + Vector3d(-120, 90, -200), 8));
  scene.map = test::render(all, test::bumpy_camera(640));
  test::add_noise(scene.map, kNoise, 5);
  test::punch_holes(scene.map, 0.15, 6);
  scene.visible = test::visible(scene.moved.vertices, all, scene.map);
  return scene;
}

/// Distances [mm] from the true places of the visible vertices: of all, and along the true normal.
void report_errors(benchmark::State& state, const Scene& scene, const Eigen::Matrix3Xd& found) {
  const Eigen::Matrix3Xd normals = vertex_normals(scene.moved);
  std::vector<double> whole;
  std::vector<double> along_normal;
  std::vector<double> hidden;
  for (Eigen::Index v = 0; v < found.cols(); ++v) {
    const Vector3d error = found.col(v) - scene.moved.vertices.col(v);
    if (!scene.visible[static_cast<std::size_t>(v)]) {
      hidden.push_back(error.norm());
      continue;
    }
    whole.push_back(error.norm());
    along_normal.push_back(error.dot(normals.col(v)));
  }
  std::ranges::sort(whole);
  state.counters["rms"] = error_statistics(whole).rms;
  state.counters["p95"] = whole[whole.size() * 95 / 100];
  state.counters["max"] = whole.back();
  state.counters["normal_rms"] = error_statistics(along_normal).rms;
  state.counters["hidden_rms"] = error_statistics(hidden).rms;
}

void against_rigid(benchmark::State& state) {
  const auto kind = static_cast<Kind>(state.range(0));
  const Scene scene = make_scene(kind);
  const double build = palpate::bench::seconds(
      [&] { DeformationGraph(scene.rest, {.nodes = static_cast<int>(state.range(1))}); });
  const DeformationGraph graph(scene.rest, {.nodes = static_cast<int>(state.range(1))});
  const TriangleMesh target = mesh_range_map(scene.map).mesh;
  DeformedSurface ours;
  Registration peer;
  palpate::bench::run_paired(
      state, [&] { ours = register_deformed(graph, scene.map); },
      [&] { peer = register_points(scene.rest.vertices, target, {.max_iterations = 10}); });
  if (ours.stop != NonRigidStop::converged) state.SkipWithError("not converged");
  report_errors(state, scene, ours.vertices);
  const Eigen::Matrix3Xd rigid = peer.T_target_source * scene.rest.vertices;
  if (kind != plate && state.counters["rms"] > (rigid - scene.moved.vertices).norm() /
                                                   std::sqrt(static_cast<double>(rigid.cols()))) {
    state.SkipWithError("the rigid motion is nearer to the truth");
  }
  state.counters["build_ms"] = 1e3 * build;
  state.counters["iterations"] = ours.iterations;
  state.counters["vertices"] = static_cast<double>(ours.vertices.cols());
}
BENCHMARK(against_rigid)
    ->ArgNames({"kind", "nodes"})
    ->Args({block, 200})
    ->Args({block, 400})
    ->Args({block, 800})
    ->Args({block, 1600})
    ->Args({plate, 800})
    ->Iterations(4)
    ->Unit(benchmark::kMillisecond);

/// A frame of which something before it, 400 mm from the camera, hides a part: tracked from the one
/// before, against staying where that was.
void frame_that_is_partly_hidden(benchmark::State& state) {
  const Scene before = make_scene(block, 15);
  Scene scene = make_scene(block, 20);
  const DeformationGraph graph(scene.rest);
  const DeformedSurface start = register_deformed(graph, before.map);
  const Eigen::Index cols = scene.map.z.cols();
  constexpr float kBefore = 400;  // mm
  scene.map.z.leftCols(cols * state.range(0) / 100) = kBefore;
  DeformedSurface found;
  for ([[maybe_unused]] auto _ : state) {
    found = register_deformed(graph, scene.map, {.min_matched = 0}, start.node_motions);
  }
  const auto with = [&](VertexSight sight) {
    return static_cast<double>(std::ranges::count(found.sight, sight));
  };
  report_errors(state, scene, start.vertices);
  state.counters["rms_of_staying"] = state.counters["rms"];
  report_errors(state, scene, found.vertices);
  state.counters["visible"] = with(VertexSight::seen) / (static_cast<double>(found.sight.size()) -
                                                         with(VertexSight::turned_away));
  state.counters["settled"] = found.stop == NonRigidStop::converged ? 1 : 0;
}
BENCHMARK(frame_that_is_partly_hidden)
    ->ArgName("hidden_percent")
    ->Arg(0)
    ->Arg(20)
    ->Arg(40)
    ->Arg(60)
    ->Arg(80)
    ->Arg(90)
    ->Arg(97)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
