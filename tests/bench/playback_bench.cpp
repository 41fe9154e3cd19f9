// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// One step of the haptic loop, on surfaces of 200 to two million triangles: free against one ray of
// Embree used directly, which is what any proxy algorithm needs at least; slipping against Brent's
// method (thesis 5.4.2).
#include "palpate/haptics/playback.h"

#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "height_field_model.h"
#include "paired.h"
#include "surface_query_peers.h"

namespace {

namespace haptics = palpate::haptics;
using Eigen::Vector3d;

constexpr double kHalfSize = 100;  // [mm]
constexpr int kTicks = 4000;

double hills(double x, double y) {
  return 6 * std::sin(x / 12.7) * std::cos(y / 9.5) + std::sin((x + 0.6 * y) / 4);
}

haptics::Model hill_model(int cells, double friction) {
  return haptics::height_field_model({.height = hills,
                                      .friction = friction,
                                      .uneven = true,
                                      .half_size = kHalfSize,
                                      .cells = cells,
                                      .grid = cells == 10 ? 5 : 10});
}

/// A tool that wanders over the surface at this height [mm] above the hills, at 1 kHz.
std::vector<Vector3d> wander(double height) {
  std::vector<Vector3d> path;
  for (int i = 0; i < kTicks; ++i) {
    const double t = 1e-3 * i;
    const double x = 70 * std::sin(2.3 * t), y = 70 * std::sin(3.3 * t + 0.5);
    path.emplace_back(x, y, hills(x, y) + height);
  }
  return path;
}

void play(const haptics::Playback& playback, const std::vector<Vector3d>& path) {
  haptics::LoopState state;
  for (const Vector3d& tool : path) benchmark::DoNotOptimize(playback.step(tool, state));
}

/// One ray through the surface at each place of the path.
void cast(const palpate::bench::EmbreePeer& embree, const std::vector<Vector3d>& path) {
  for (const Vector3d& tool : path) {
    benchmark::DoNotOptimize(
        embree.first_crossing(tool + 10 * Vector3d::UnitZ(), -20 * Vector3d::UnitZ(), 1));
  }
}

void report_us(benchmark::State& state) {
  state.counters["us"] = 1e3 * state.counters["ours_ms"] / kTicks;
  state.counters["peer_us"] = 1e3 * state.counters["peer_ms"] / kTicks;
}

void free_against_a_ray(benchmark::State& state) {
  const haptics::Model model = hill_model(static_cast<int>(state.range(0)), 0.5);
  const haptics::Playback playback(model);
  const palpate::bench::EmbreePeer embree(model.surface);
  const std::vector<Vector3d> path = wander(8);
  palpate::bench::run_paired(
      state, [&] { play(playback, path); }, [&] { cast(embree, path); });
  report_us(state);
}
BENCHMARK(free_against_a_ray)->Arg(10)->Arg(100)->Arg(1000)->Unit(benchmark::kMillisecond);

void slip_against_a_ray(benchmark::State& state) {
  const haptics::Model model =
      hill_model(static_cast<int>(state.range(0)), static_cast<double>(state.range(1)) / 100);
  const haptics::Playback playback(model);
  const palpate::bench::EmbreePeer embree(model.surface);
  std::vector<Vector3d> path = wander(-3.5);
  path.insert(path.begin(), path.front() + 12 * Vector3d::UnitZ());
  palpate::bench::run_paired(
      state, [&] { play(playback, path); }, [&] { cast(embree, path); });
  report_us(state);
}
BENCHMARK(slip_against_a_ray)
    ->ArgsProduct({{10, 100, 1000}, {50}})
    ->ArgsProduct({{100}, {0, 5, 20}})
    ->Unit(benchmark::kMillisecond);

void slip_against_brent(benchmark::State& state) {
  const haptics::Model model = hill_model(static_cast<int>(state.range(0)), 0.5);
  const haptics::Playback playback(model);
  const haptics::Playback brent(model, {.motion = haptics::ContactMotion::brent});
  std::vector<Vector3d> path = wander(-3.5);
  path.insert(path.begin(), path.front() + 12 * Vector3d::UnitZ());
  palpate::bench::run_paired(
      state, [&] { play(playback, path); }, [&] { play(brent, path); });
  report_us(state);
}
BENCHMARK(slip_against_brent)->Arg(100)->Unit(benchmark::kMillisecond);

/// Weights, blend and force at a new place, against the same by `BlendedField`.
void place_against_blended_field(benchmark::State& state) {
  const haptics::PackedField field(hill_model(100, 0.5));
  const haptics::BlendedField& blended = field.blended();
  std::vector<palpate::geometry::ClosestPoint> places;
  for (const Vector3d& tool : wander(0)) places.push_back(blended.surface().closest_point(tool));
  const Vector3d push(1, 0.5, -3);
  palpate::bench::run_paired(
      state,
      [&] {
        haptics::PlaceField at;
        for (const auto& place : places) {
          field.move_to(place.at, place.position, at);
          benchmark::DoNotOptimize(field.force(at, push));
        }
      },
      [&] {
        for (const auto& place : places)
          benchmark::DoNotOptimize(blended.force(blended.blend(place.at), push));
      });
  report_us(state);
}
BENCHMARK(place_against_blended_field)->Unit(benchmark::kMillisecond);

}  // namespace
