// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The geodesic Delaunay triangulation of contacts by coarsening against the Voronoi dual, on a
// range map with noise and holes; and how long it takes to locate a place in it.
#include "palpate/geometry/contact_triangulation.h"

#include <random>
#include <set>
#include <vector>

#include "mesh_corpus.h"
#include "paired.h"
#include "palpate/geometry/contact_locator.h"

namespace {

using palpate::geometry::ContactTriangulation;
using palpate::geometry::ContactTriangulationMethod;
using palpate::geometry::ContactWeights;
using palpate::geometry::SurfacePoint;
using palpate::geometry::TriangleMesh;

constexpr double kNoise = 0.25;  // [mm]

std::vector<SurfacePoint> random_places(const TriangleMesh& mesh, int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> any(0, static_cast<int>(mesh.triangles.cols()) - 1);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<SurfacePoint> places;
  std::set<int> triangles;
  while (static_cast<int>(places.size()) < count) {
    const int t = any(random);
    if (!triangles.insert(t).second) continue;
    const double s = uniform(random), r = uniform(random);
    places.push_back({.triangle = t, .barycentric = {1 - s, s * (1 - r), s * r}});
  }
  return places;
}

/// Every vertex has weights, every contact has influence on one.
bool is_whole(const ContactTriangulation& result) {
  std::set<int> contacts;
  for (const int contact : result.weights.contacts.reshaped()) contacts.insert(contact);
  contacts.erase(-1);
  return result.weights.contacts.row(0).minCoeff() >= 0 &&
         static_cast<Eigen::Index>(contacts.size()) == result.mesh.vertices.cols();
}

void coarsening_against_voronoi_dual(benchmark::State& state) {
  const TriangleMesh mesh =
      palpate::geometry::test::bumpy(static_cast<int>(state.range(0)), kNoise);
  const std::vector<SurfacePoint> contacts =
      random_places(mesh, static_cast<int>(state.range(1)), 3);
  ContactTriangulation ours;
  ContactTriangulation peer;
  palpate::bench::run_paired(
      state, [&] { ours = palpate::geometry::triangulate_contacts(mesh, contacts); },
      [&] {
        peer = palpate::geometry::triangulate_contacts(
            mesh, contacts, {.method = ContactTriangulationMethod::voronoi_dual});
      });
  if (!is_whole(ours)) state.SkipWithError("contacts were left out");
  state.counters["triangles"] = static_cast<double>(mesh.triangles.cols());
  state.counters["helpers"] = static_cast<double>(ours.intrinsic.helpers.cols());
  state.counters["left_out"] = static_cast<double>(ours.isolated.size());
  state.counters["left_out_by_dual"] = static_cast<double>(peer.isolated.size());
}
BENCHMARK(coarsening_against_voronoi_dual)
    ->Args({300000, 100})
    ->Args({300000, 1000})
    ->Unit(benchmark::kMillisecond);

/// `step`: how many triangles further the next place is; a range map's neighbours have near
/// indices.
void locate(benchmark::State& state, int step) {
  const TriangleMesh mesh = palpate::geometry::test::bumpy(300000, kNoise);
  const std::vector<SurfacePoint> contacts =
      random_places(mesh, static_cast<int>(state.range(0)), 3);
  const palpate::geometry::ContactLocator locator(
      mesh, contacts, palpate::geometry::triangulate_contacts(mesh, contacts).weights);
  SurfacePoint place{.triangle = 0, .barycentric = {0.2, 0.3, 0.5}};
  double sum = 0;
  for ([[maybe_unused]] auto _ : state) {
    const ContactWeights found = locator.locate(place);
    sum += found.weights[0];
    if (found.count == 0) state.SkipWithError("a place has no contact");
    place.triangle = (place.triangle + step) % static_cast<int>(mesh.triangles.cols());
  }
  benchmark::DoNotOptimize(sum);
}
// A contact that moves, as in the haptic loop; and places all over the surface, hardly any of which
// is in the cache when its turn comes.
BENCHMARK_CAPTURE(locate, moving, 1)->Arg(100)->Arg(1000)->Unit(benchmark::kNanosecond);
BENCHMARK_CAPTURE(locate, anywhere, 104729)->Arg(100)->Arg(1000)->Unit(benchmark::kNanosecond);

}  // namespace
