// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The haptic loop against the least that any proxy algorithm does on the same surface: one segment
// query and one nearest point a step, no force field and no friction.
#include "palpate/haptics/playback.h"

#include <filesystem>
#include <vector>

#include "paired.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/haptics/build_model.h"
#include "palpate/haptics/trajectory_csv.h"
#include "palpate/probing/acquisition_csv.h"
#include "repository.h"

namespace {

namespace geometry = palpate::geometry;
namespace haptics = palpate::haptics;

/// A proxy without friction: where the tool is behind the surface, its nearest point.
void play_proxy(const geometry::SurfaceQuery& surface,
                const std::vector<haptics::TrajectoryPoint>& trajectory) {
  Eigen::Vector3d last = trajectory.front().tool;
  for (const haptics::TrajectoryPoint& point : trajectory) {
    benchmark::DoNotOptimize(surface.first_hit(last, point.tool));
    benchmark::DoNotOptimize(surface.closest_point(point.tool));
    last = point.tool;
  }
}

void playback_against_proxy(benchmark::State& state) {
  const std::filesystem::path demo = palpate::repository("demo");
  const haptics::Model model =
      haptics::build_model(palpate::probing::read_acquisition_csv(demo / "sheet/contacts.csv",
                                                                  demo / "sheet/samples.csv"),
                           geometry::read_mesh(demo / "sheet/surface.ply"))
          .model;
  const haptics::Playback playback(model);
  const geometry::SurfaceQuery surface(model.surface);
  const std::vector<haptics::TrajectoryPoint> trajectory =
      haptics::read_trajectory(demo / "trajectory.csv");
  palpate::bench::run_paired(
      state, [&] { benchmark::DoNotOptimize(haptics::play(playback, trajectory)); },
      [&] { play_proxy(surface, trajectory); });
  state.counters["us_per_step"] =
      1e3 * state.counters["ours_ms"] / static_cast<double>(trajectory.size());
}
BENCHMARK(playback_against_proxy)->Unit(benchmark::kMillisecond);

}  // namespace
