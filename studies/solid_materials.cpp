// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
//
// Accuracy of the materials that `palpate identify --finite-elements` finds of simulated solids,
// for docs/identify.md. The measurements come from meshes that differ from those of the estimate.
// `solid_materials 1 2 3` does that with the seeds 1, 2 and 3.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "palpate/core/parallel_for.h"
#include "palpate/haptics/identify_solid.h"
#include "palpate/probing/probed_solid.h"
#include "palpate/probing/specimen_file.h"

namespace palpate {
namespace {

using Eigen::Vector3d;

struct Solid {
  std::string name;
  std::string truth, given;    // specimen files
  std::vector<double> values;  // true ones of the parameters
  double x = 0, y = 0;         // [mm] half of the area with contacts
  double force = 1;            // [N] the largest normal force
};

// A block of 60 x 60 x 20 mm whose halves differ.
std::string halves(const char* cells, double left, double right, double ratio) {
  return fmt::format(R"({{"type": "finite_elements", "cells": {}, "shear_modulus": {},
      "bulk_modulus": {}, "regions": [{{"low": [0, -31, 699], "high": [31, 31, 721],
      "shear_modulus": {}, "bulk_modulus": {}}}]}})",
                     cells, left, ratio * left, right, ratio * right);
}

// The same block with a box inside, 4 mm below the surface.
std::string inclusion(const char* cells, double around, double inside, double ratio) {
  return fmt::format(R"({{"type": "finite_elements", "cells": {}, "shear_modulus": {},
      "bulk_modulus": {}, "regions": [{{"low": [-10, -10, 704], "high": [10, 10, 716],
      "shear_modulus": {}, "bulk_modulus": {}}}]}})",
                     cells, around, ratio * around, inside, ratio * inside);
}

// A sheet of 80 x 60 x 4 mm, pulled apart along x by `stretch` times 4 mm at each side.
std::string sheet(const char* cells, double shear, double ratio, double stretch) {
  return fmt::format(R"({{"type": "finite_elements", "size": [80, 60, 4], "cells": {},
      "shear_modulus": {}, "bulk_modulus": {}, "supports": [
      {{"side": "left", "move": [{}, 0, 0]}}, {{"side": "right", "move": [{}, 0, 0]}}]}})",
                     cells, shear, ratio * shear, -4 * stretch, 4 * stretch);
}

std::vector<Vector3d> places(const Solid& solid) {
  std::vector<Vector3d> result;  // 46: rows of 6, 7, ... shifted by half
  for (int row = 0; row < 7; ++row) {
    const int count = row % 2 == 0 ? 7 : 6;
    for (int k = 0; k < count; ++k)
      result.emplace_back(solid.x * (2.0 * (k + (row % 2 == 0 ? 0 : 0.5)) / 6 - 1),
                          solid.y * (2.0 * row / 6 - 1), 700);
  }
  return result;
}

// A trial without noise, and how it answers to an error of the force.
struct Trial {
  std::size_t contact = 0;
  int level = 0;
  Vector3d force, displacement;
  Eigen::Matrix3d compliance;
};

struct Measured {
  std::vector<probing::Contact> contacts;
  std::vector<Trial> trials;
};

Measured exact_trials(const Solid& solid) {
  const probing::FiniteElementObject object = probing::parse_finite_elements(solid.truth, "truth");
  const probing::ProbedSolid truth(object.body, object.options);
  Measured result;
  for (const Vector3d& place : places(solid)) {
    const probing::ProbedPlace at = truth.place(place);
    result.contacts.push_back(
        {static_cast<long long>(result.contacts.size()), at.position, -at.inward});
  }
  constexpr int kLevels = 3, kDirections = 4;
  constexpr double kDrag = 0.35;  // of the normal force
  constexpr std::size_t kEach = kLevels * (1 + kDirections);
  result.trials.resize(kEach * result.contacts.size());
  parallel_for(result.contacts.size(), [&](std::size_t c) {
    const Vector3d inward = -result.contacts[c].normal;
    probing::ContactSeries series(truth.equilibrium(),
                                  truth.equilibrium().touch(result.contacts[c].position, inward));
    std::size_t next = kEach * c;
    for (int level = 0; level < kLevels; ++level) {
      const double pressed = solid.force * (level + 1.0) / kLevels;
      Eigen::Matrix3d compliance;  // of all trials of a level: it serves the noise alone
      for (int k = 0; k <= kDirections; ++k) {
        // Other directions at each contact.
        const double angle = std::numbers::pi / 2 * k + 0.4 * static_cast<double>(c);
        const Vector3d side = inward.cross(Vector3d::UnitY()).normalized();
        const Vector3d other = inward.cross(side);
        Vector3d force = pressed * inward;
        if (k > 0) force += kDrag * pressed * (std::cos(angle) * side + std::sin(angle) * other);
        const probing::ContactResult found = series.apply_force(force);
        if (found.stop != probing::ContactStop::converged)
          throw std::runtime_error("no equilibrium");
        if (k == 0) compliance = series.sensitivity(found.state, {}).compliance;
        result.trials[next++] = {c, level, force, found.state.tip - series.from().tip, compliance};
      }
    }
  });
  return result;
}

// The noise of docs/probing.md: 0.02 mm of positions, rounded to 0.03 mm, and 0.01 N of forces.
probing::Acquisition with_noise(const Measured& measured, unsigned seed) {
  constexpr double kPosition = 0.02, kQuantum = 0.03, kForce = 0.01;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto position = [&](const Trial& trial) {
    Vector3d force_error, error;
    for (int i = 0; i < 3; ++i) force_error[i] = kForce * normal(random);
    for (int i = 0; i < 3; ++i) error[i] = kPosition * normal(random);
    const Vector3d at = measured.contacts[trial.contact].position + trial.displacement +
                        trial.compliance * force_error + error;
    return Vector3d((at / kQuantum).array().round() * kQuantum);
  };
  probing::Acquisition result;
  result.contacts = measured.contacts;
  result.probe_radius = 5;
  const Trial* press = nullptr;
  for (const Trial& trial : measured.trials) {
    if (!press || press->contact != trial.contact || press->level != trial.level) {
      press = &trial;
      continue;
    }
    probing::Sample sample;
    sample.id = static_cast<long long>(result.samples.size());
    sample.contact = static_cast<long long>(trial.contact);
    sample.group = trial.level;
    sample.force = trial.force;
    sample.a = position(*press);
    sample.b = position(trial);
    result.samples.push_back(sample);
  }
  return result;
}

void run(const Solid& solid, const std::vector<unsigned>& seeds) {
  const Measured measured = exact_trials(solid);
  const probing::FiniteElementObject given = probing::parse_finite_elements(solid.given, "given");
  for (const unsigned seed : seeds) {
    const auto begin = std::chrono::steady_clock::now();
    const haptics::IdentifiedSolid found =
        haptics::identify_solid(with_noise(measured, seed), given);
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    for (std::size_t k = 0; k < solid.values.size(); ++k) {
      const haptics::ParameterEstimate& estimate = found.report.parameters[k];
      if (!estimate.standard_error) {
        fmt::print("| {} {} | {} | {:.4g} | {} | | | | |\n", solid.name, seed, estimate.name,
                   solid.values[k], to_string(estimate.status));
        continue;
      }
      const double error = *estimate.value - solid.values[k];
      fmt::print("| {} {} | {} | {:.4g} | {:.4g} | {:+.1f} % | {:.1f} % | {:+.1f} | {:+.1f} % |\n",
                 solid.name, seed, estimate.name, solid.values[k], *estimate.value,
                 100 * error / solid.values[k], 100 * *estimate.standard_error / solid.values[k],
                 error / *estimate.standard_error, 100 * found.mesh_errors[k] / solid.values[k]);
    }
    fmt::print("{} {}: {}, chi^2 {:.2f}, RMS {:.3f} mm, {} pairs, {} iterations, {:.0f} s\n",
               solid.name, seed, to_string(found.report.verdict), found.report.chi2.value_or(-1),
               found.report.rms, found.report.pairs, found.report.iterations, seconds);
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  using namespace palpate;
  std::vector<unsigned> seeds;
  for (int i = 1; i < argc; ++i) seeds.push_back(static_cast<unsigned>(std::stoul(argv[i])));
  if (seeds.empty()) seeds = {1};
  run({"halves",
       halves("[12, 12, 4]", 0.03, 0.08, 12),
       halves("[10, 10, 3]", 0.05, 0.05, 20),
       {0.03, 0.08, 12},
       24,
       24,
       1.2},
      seeds);
  run({"inclusion",
       inclusion("[12, 12, 5]", 0.04, 0.16, 12),
       inclusion("[9, 9, 5]", 0.05, 0.05, 20),
       {0.04, 0.16, 12},
       24,
       24,
       1.2},
      seeds);
  run({"sheet",
       sheet("[22, 16, 2]", 0.2, 12, 1.2),
       sheet("[16, 12, 1]", 0.1, 20, 0.8),
       {0.2, 12, 1.2},
       28,
       24,
       0.8},
      seeds);
}
