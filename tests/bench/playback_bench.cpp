// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// One step of the haptic loop, on surfaces of 200 to two million triangles: free against one ray of
// Embree used directly, which is what any proxy algorithm needs at least; slipping against Brent's
// method (thesis 5.4.2); and the distribution of its time (docs/trade-playback.md).
#include "palpate/haptics/playback.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "height_field_model.h"
#include "paired.h"
#include "palpate/haptics/contact_compliance.h"
#include "palpate/haptics/rotation.h"
#include "palpate/haptics/scene.h"
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

/// Cost of a model that depends on rate and load, against the same without. Arguments: terms of the
/// rate, whether friction depends on the load, and the height above the surface [mm].
void laws_against_none(benchmark::State& state) {
  const haptics::Model plain = hill_model(100, 0.5);
  haptics::Model model = plain;
  for (int i = 0; i < state.range(0); ++i) model.rate.push_back({0.3, i == 0 ? 0.05 : 0.5});
  if (state.range(1) != 0) {
    model.friction_force = 1;
    for (haptics::ContactModel& contact : model.contacts) contact.load_exponent = -0.1;
  }
  const haptics::Playback with(model), without(plain);
  std::vector<Vector3d> path = wander(static_cast<double>(state.range(2)));
  path.insert(path.begin(), path.front() + 20 * Vector3d::UnitZ());
  palpate::bench::run_paired(
      state, [&] { play(with, path); }, [&] { play(without, path); });
  report_us(state);
}
BENCHMARK(laws_against_none)
    ->ArgNames({"terms", "load", "height"})
    ->ArgsProduct({{1, 2}, {0}, {-4, 8}})
    ->ArgsProduct({{0}, {1}, {-4}})
    ->Unit(benchmark::kMillisecond);

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

constexpr int kRepeats = 6;
// With cold caches a tick takes ten milliseconds to prepare.
constexpr int kColdRepeats = 2;
constexpr std::size_t kColdTicks = 300;

/// [us] of each tick: the least of the repeats, without the clock's own time.
struct TimedPath {
  std::vector<double> times;
  std::vector<haptics::ContactState> states;
};

double microseconds(auto&& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return 1e6 * std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// [us] that reading the clock takes.
double clock_time() {
  double clock = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 1000; ++i) clock = std::min(clock, microseconds([] {}));
  return clock;
}

/// \param flushed overwritten before each tick; larger than the caches for a cold start.
TimedPath time_path(const haptics::Playback& playback, const std::vector<Vector3d>& path,
                    std::vector<char>& flushed) {
  constexpr std::size_t kCacheLine = 64;
  const double clock = clock_time();
  TimedPath result{
      .times = std::vector<double>(path.size(), std::numeric_limits<double>::infinity()),
      .states = std::vector<haptics::ContactState>(path.size())};
  const int repeats = flushed.empty() ? kRepeats : kColdRepeats;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    haptics::LoopState state;
    for (std::size_t i = 0; i < path.size(); ++i) {
      for (std::size_t k = 0; k < flushed.size(); k += kCacheLine) ++flushed[k];
      haptics::Command command;
      const double time = microseconds([&] { command = playback.step(path[i], state); });
      result.times[i] = std::min(result.times[i], time - clock);
      result.states[i] = command.state;
    }
  }
  return result;
}

void report(benchmark::State& state, const std::string& name, std::vector<double> times) {
  if (times.empty()) return;
  std::ranges::sort(times);
  double sum = 0;
  for (const double time : times) sum += time;
  const auto count = static_cast<double>(times.size());
  const auto at = [&](double part) { return times[static_cast<std::size_t>(part * (count - 1))]; };
  state.counters[name + "_mean"] = sum / count;
  state.counters[name + "_p99"] = at(0.99);
  state.counters[name + "_p99.9"] = at(0.999);
}

/// As many bases as asked for: the six, then copies of them with half the weight elsewhere.
haptics::Model with_bases(haptics::Model model, int bases) {
  for (haptics::ContactModel& contact : model.contacts) {
    std::vector<haptics::Multiquadric>& all = contact.field.bases;
    const std::size_t given = all.size();
    for (std::size_t i = given; i < static_cast<std::size_t>(bases); ++i) {
      all.push_back(all[i % given]);
      all.back().weight *= 0.5;
      all.back().center += Vector3d(2, -1, 1);
    }
    all.resize(static_cast<std::size_t>(bases));
  }
  return haptics::with_compliances(std::move(model), 1);
}

/// Arguments: cells along each side (2 n^2 triangles), contacts along each side, bases, friction in
/// percent, megabytes that are overwritten between ticks.
void step_times(benchmark::State& state) {
  const auto cells = static_cast<int>(state.range(0)), grid = static_cast<int>(state.range(1));
  const haptics::Model model =
      with_bases(haptics::height_field_model({.height = hills,
                                              .friction = static_cast<double>(state.range(3)) / 100,
                                              .uneven = true,
                                              .half_size = kHalfSize,
                                              .cells = cells,
                                              .grid = grid}),
                 static_cast<int>(state.range(2)));
  const haptics::Playback playback(model);
  std::vector<char> flushed(static_cast<std::size_t>(state.range(4)) << 20);
  std::vector<Vector3d> free = wander(8), slide = wander(-3.5), stick;
  slide.insert(slide.begin(), slide.front() + 12 * Vector3d::UnitZ());
  for (std::size_t i = 0; i < slide.size(); ++i) {
    // 0.3 mm to and fro at a place for half a second, lifted before the next one.
    constexpr std::size_t kStay = 500, kLifted = 20;
    const double t = 1e-3 * static_cast<double>(i);
    const Vector3d place = slide[1 + i / kStay * kStay];
    stick.push_back(place + 0.3 * Vector3d(std::sin(19 * t), std::cos(31 * t), 0));
    if (i % kStay < kLifted) stick.back().z() += 20;
  }
  if (!flushed.empty()) {
    for (std::vector<Vector3d>* path : {&free, &slide, &stick}) path->resize(kColdTicks);
  }
  for (auto _ : state) {
    report(state, "free", time_path(playback, free, flushed).times);
    for (const auto& [name, path, wanted] :
         {std::tuple("stick", &stick, haptics::ContactState::stick),
          std::tuple("slip", &slide, haptics::ContactState::slip)}) {
      const TimedPath timed = time_path(playback, *path, flushed);
      std::vector<double> times;
      for (std::size_t i = 0; i < timed.times.size(); ++i) {
        if (timed.states[i] == wanted) times.push_back(timed.times[i]);
      }
      report(state, name, std::move(times));
    }
  }
}
BENCHMARK(step_times)
    ->ArgNames({"cells", "grid", "bases", "mu", "MB"})
    ->ArgsProduct({{10}, {5}, {6}, {50}, {0}})
    ->ArgsProduct({{100, 1000}, {10}, {6}, {50}, {0, 64}})
    ->ArgsProduct({{100}, {10}, {1, 2, 4, 8, 12}, {50}, {0}})
    ->ArgsProduct({{100}, {10}, {6}, {0, 5, 10, 20}, {0}})
    ->ArgsProduct({{1000}, {31, 100, 316, 1000}, {6}, {50}, {0}})
    ->Iterations(1)
    ->Unit(benchmark::kSecond);

/// A tick of a scene: tools slide over the first object, and the other objects stand in a row
/// beyond it, 0.3 m apart, or turn there. For each tick, the shortest time of all repeats.
/// Arguments: objects, tools, whether the others turn.
void scene_ticks(benchmark::State& state) {
  const auto count = static_cast<std::size_t>(state.range(0)),
             tool_count = static_cast<std::size_t>(state.range(1));
  const bool moves = state.range(2) != 0;
  const auto playback = std::make_shared<const haptics::Playback>(hill_model(100, 0.5));
  std::vector<haptics::SceneObject> objects;
  for (std::size_t i = 0; i < count; ++i) objects.push_back({std::to_string(i), playback});
  const haptics::Scene scene(std::move(objects));
  const std::vector<Vector3d> path = wander(-3.5);
  std::vector<Eigen::Isometry3d> poses(count, Eigen::Isometry3d::Identity());
  std::vector<Vector3d> tools(tool_count);
  const double clock = clock_time();
  std::vector<double> times(path.size(), std::numeric_limits<double>::infinity());
  for (auto _ : state) {
    haptics::SceneState scene_state = scene.start(static_cast<int>(tool_count));
    for (std::size_t tick = 0; tick < path.size(); ++tick) {
      for (std::size_t o = 1; o < count; ++o) {
        poses[o].translation().x() = 300.0 * static_cast<double>(o);
        if (moves) {
          poses[o].linear() = haptics::rotation_exp({0, 0, 1e-3 * static_cast<double>(tick)});
        }
      }
      for (std::size_t t = 0; t < tool_count; ++t) {
        // The same way, later by half a second; from above at first.
        tools[t] = path[(tick + 500 * t) % path.size()];
        if (tick == 0) tools[t].z() += 12;
      }
      const double time =
          microseconds([&] { benchmark::DoNotOptimize(&scene.step(poses, tools, scene_state)); });
      times[tick] = std::min(times[tick], time - clock);
    }
  }
  report(state, "us", std::move(times));
}
BENCHMARK(scene_ticks)
    ->ArgNames({"objects", "tools", "move"})
    ->ArgsProduct({{1, 10, 100, 1000}, {1}, {0, 1}})
    ->ArgsProduct({{1, 100}, {2, 4}, {1}})
    ->Iterations(kRepeats)
    ->Unit(benchmark::kMillisecond);

}  // namespace
