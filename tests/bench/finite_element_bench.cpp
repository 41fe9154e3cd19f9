// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Times of equilibria of a soft block with 3000 nodes, as in a campaign: several forces at places
// whose factors exist. Counters are quantiles over the forces [ms].
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "paired.h"
#include "palpate/probing/contact_equilibrium.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

std::vector<double> even(double from, double to, int cells) {
  std::vector<double> result;
  for (int i = 0; i <= cells; ++i) result.push_back(from + (to - from) * i / cells);
  return result;
}

DeformableBody soft_block() {
  DeformableBody body;
  body.mesh = box_mesh(even(-30, 30, 10), even(-30, 30, 10), even(0, 20, 3));
  body.materials = {{.shear_modulus = 0.05, .bulk_modulus = 1}};
  for (int n = 0; n < body.mesh.nodes.cols(); ++n)
    if (body.mesh.nodes(2, n) > 20 - 1e-9) body.supported.push_back(n);
  return body;
}

// A sheet of 100 x 60 x 2 mm, stretched by a tenth between its ends.
DeformableBody stretched_sheet() {
  DeformableBody body;
  body.mesh = box_mesh(even(-50, 50, 20), even(-30, 30, 12), even(0, 2, 1));
  body.materials = {{.shear_modulus = 0.2, .bulk_modulus = 4}};
  std::vector<double> moves;
  for (int n = 0; n < body.mesh.nodes.cols(); ++n) {
    const double x = body.mesh.nodes(0, n);
    if (std::abs(x) < 50 - 1e-9) continue;
    body.supported.push_back(n);
    moves.push_back(std::copysign(5, x));
  }
  body.support_moves.setZero(3, static_cast<Eigen::Index>(moves.size()));
  for (std::size_t k = 0; k < moves.size(); ++k)
    body.support_moves(0, static_cast<Eigen::Index>(k)) = moves[k];
  return body;
}

enum class Asked { one_by_one, in_series };

void equilibria(benchmark::State& state, const DeformableBody& body, Asked asked) {
  const ContactEquilibrium solid(body);
  const ContactState start = solid.touch({3.3, -4.1, 0}, Vector3d::UnitZ());
  std::vector<Vector3d> forces;
  for (const double normal : {0.1, 0.3, 0.6, 1.2, 1.8}) {
    for (const double across : {0.0, 0.4, 0.7}) {
      const double angle = 2.4 * static_cast<double>(forces.size());
      forces.emplace_back(across * normal * std::cos(angle), across * normal * std::sin(angle),
                          normal);
    }
  }
  (void)solid.apply_force(start, forces[0]);  // makes the factors of the place
  std::vector<double> times;
  double factorisations = 0, iterations = 0;
  for ([[maybe_unused]] auto _ : state) {
    ContactSeries series(solid, start);
    for (const Vector3d& force : forces) {
      ContactResult result;
      times.push_back(1e3 * bench::seconds([&] {
                        result = asked == Asked::in_series ? series.apply_force(force)
                                                           : solid.apply_force(start, force);
                      }));
      factorisations += result.factorisations;
      iterations += result.iterations;
      if (result.stop != ContactStop::converged) state.SkipWithError("an equilibrium is missing");
    }
  }
  std::sort(times.begin(), times.end());
  const auto quantile = [&](double part) {
    return times[static_cast<std::size_t>(part * static_cast<double>(times.size() - 1))];
  };
  state.counters["nodes"] = static_cast<double>(body.mesh.nodes.cols());
  state.counters["median_ms"] = quantile(0.5);
  state.counters["p95_ms"] = quantile(0.95);
  state.counters["iterations"] = iterations / static_cast<double>(times.size());
  state.counters["factorisations"] = factorisations / static_cast<double>(times.size());
}

void block_one_by_one(benchmark::State& state) {
  equilibria(state, soft_block(), Asked::one_by_one);
}
void block_in_series(benchmark::State& state) { equilibria(state, soft_block(), Asked::in_series); }
void sheet_one_by_one(benchmark::State& state) {
  equilibria(state, stretched_sheet(), Asked::one_by_one);
}
void sheet_in_series(benchmark::State& state) {
  equilibria(state, stretched_sheet(), Asked::in_series);
}

BENCHMARK(block_one_by_one)->Unit(benchmark::kMillisecond)->Iterations(3);
BENCHMARK(block_in_series)->Unit(benchmark::kMillisecond)->Iterations(3);
BENCHMARK(sheet_one_by_one)->Unit(benchmark::kMillisecond)->Iterations(3);
BENCHMARK(sheet_in_series)->Unit(benchmark::kMillisecond)->Iterations(3);

}  // namespace
}  // namespace palpate::probing
