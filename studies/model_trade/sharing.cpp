// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "sharing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "beam_contacts.h"
#include "measure.h"
#include "palpate/haptics/shared_local_part.h"

namespace palpate::bench {
namespace {

using haptics::ForceSamples;

constexpr std::size_t kDense = 6;
// Pairs that a dense contact has at least: more than those of any sparse probing here.
constexpr int kDenseSamples = 60;

// Tangential over normal force at a sparse contact.
constexpr double kRatio = 0.5;

/// Samples that are taken at a sparse contact: each normal force alone and with a tangential one.
struct Plan {
  std::vector<double> normal_forces;  // [N]
  int directions;

  [[nodiscard]] std::size_t samples() const {
    return normal_forces.size() * static_cast<std::size_t>(1 + directions);
  }
};

const std::vector<Plan> kPlans = {
    {{2}, 4}, {{0.8, 2.4}, 4}, {{0.4, 1, 1.8, 2.8}, 4}, {{0.3, 0.7, 1.2, 1.9, 2.8}, 7}};

// RMS against the truth, one for each contact that is sparse.
struct Errors {
  std::vector<double> own, shared, full;
  int objects = 0, sharing = 0;
};

bool is_dense(std::size_t contact, std::size_t count) {
  for (std::size_t k = 0; k < kDense; ++k) {
    if (contact == (2 * k + 1) * count / (2 * kDense)) return true;
  }
  return false;
}

double own_error(const ForceSamples& samples, const ForceSamples& truth,
                 const haptics::FitNoise& noise) {
  return haptics::rms_error(
      haptics::fit_force_field(samples.displacements, samples.forces, {.noise = noise}).field,
      truth);
}

void add_plan(const haptics::ProbedContacts& probed, const std::vector<ForceSamples>& sparse,
              Errors& errors) {
  std::vector<ForceSamples> contacts = sparse;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (is_dense(i, contacts.size())) contacts[i] = probed.dense[i];
  }
  const haptics::LocalPart part =
      haptics::learn_local_part(contacts, {.dense_samples = kDenseSamples});
  const bool shares = part.outcome == haptics::SharingOutcome::shared;
  ++errors.objects;
  errors.sharing += shares ? 1 : 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (is_dense(i, contacts.size())) continue;
    const ForceSamples& truth = probed.truth[i];
    errors.own.push_back(own_error(sparse[i], truth, part.noise));
    // Without a local part it is the same fit.
    errors.shared.push_back(
        shares ? haptics::rms_error(haptics::fit_with_local_part(sparse[i], part).fit.field, truth)
               : errors.own.back());
  }
}

// Within a quarter of what it is.
double varied(double value, std::mt19937& random) {
  return value * std::uniform_real_distribution<double>(0.8, 1.25)(random);
}

support::Beam varied_beam(double local_variation, unsigned seed) {
  std::mt19937 random(seed);
  support::Beam beam{.local_variation = local_variation};
  for (double* value : {&beam.shear, &beam.pressed, &beam.pressed_force, &beam.coupled,
                        &beam.bending, &beam.sideways, &beam.twisting}) {
    *value = varied(*value, random);
  }
  return beam;
}

support::Strip varied_sheet(bool block, unsigned seed) {
  std::mt19937 random(seed);
  support::Strip sheet;
  for (double* value : {&sheet.tension, &sheet.axial, &sheet.compliance}) {
    *value = varied(*value, random);
  }
  if (block) {
    sheet.block = 1.5;
    const Eigen::Vector2d moved(varied(40, random) - 40, varied(40, random) - 40);
    sheet.block_low += moved;
    sheet.block_high += moved;
  }
  return sheet;
}

template <typename Object>
void add_object(const Object& object, const std::vector<Eigen::Vector2d>& places, unsigned seed,
                std::vector<Errors>& errors) {
  const haptics::ProbedContacts probed =
      haptics::probed_contacts(object, places, {.dense = {.seed = 1000 * seed}});
  const haptics::FitNoise noise{haptics::pooled_displacement_noise(probed.dense)};
  std::vector<double> full;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (is_dense(i, places.size())) continue;
    full.push_back(own_error(probed.dense[i], probed.truth[i], noise));
  }
  for (std::size_t k = 0; k < kPlans.size(); ++k) {
    const support::StripProbing sparse{.normal_forces = kPlans[k].normal_forces,
                                       .directions = kPlans[k].directions,
                                       .seed = 1000 * seed + 500};
    add_plan(probed, haptics::sparse_samples(object, places, sparse, kRatio), errors[k]);
    errors[k].full.insert(errors[k].full.end(), full.begin(), full.end());
  }
}

void print_rows(const std::string& object, const std::vector<Errors>& errors) {
  for (std::size_t k = 0; k < kPlans.size(); ++k) {
    const Errors& e = errors[k];
    fmt::print("| {} | {} | {} of {} | {:.3f} | {:.3f} | {:.3f} | {:.3f} | {:.3f} | {:.3f} |\n",
               object, kPlans[k].samples(), e.sharing, e.objects, quantile(e.own, 0.5),
               quantile(e.own, 0.9), quantile(e.shared, 0.5), quantile(e.shared, 0.9),
               quantile(e.full, 0.5), quantile(e.full, 0.9));
  }
  std::fflush(stdout);
}

}  // namespace

void measure_sharing(unsigned seeds) {
  fmt::print(
      "\n| object | samples | shared in | own: median [N] | 90 % [N] | shared: median [N] | 90 % "
      "[N] | all samples: median [N] | 90 % [N] |\n|---|---|---|---|---|---|---|---|---|\n");
  for (const double variation : {0.0, 0.1}) {
    std::vector<Errors> errors(kPlans.size());
    for (unsigned seed = 1; seed <= seeds; ++seed) {
      const support::Beam beam = varied_beam(variation, seed);
      add_object(beam, support::beam_places(beam), seed, errors);
    }
    print_rows(variation > 0 ? "beam of uneven foam" : "beam", errors);
  }
  for (const bool block : {false, true}) {
    std::vector<Errors> errors(kPlans.size());
    for (unsigned seed = 1; seed <= seeds; ++seed) {
      add_object(varied_sheet(block, seed), support::strip_places(), seed, errors);
    }
    print_rows(block ? "sheet with block" : "sheet", errors);
  }
}

}  // namespace palpate::bench
