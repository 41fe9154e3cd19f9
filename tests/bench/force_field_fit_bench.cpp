// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The default fit of a contact's field against what one would take from a textbook: multiquadrics
// at all samples that go through each of them, a dense solve.
#include "palpate/haptics/force_field_fit.h"

#include <vector>

#include "model_trade/peers.h"
#include "paired.h"
#include "palpate/haptics/realignment.h"
#include "strip_acquisition.h"

namespace {

namespace haptics = palpate::haptics;
namespace support = palpate::support;

/// The contacts of a sheet, with a block below it or without.
void fit_against_interpolation(benchmark::State& state, bool block) {
  const palpate::probing::Acquisition acquisition =
      support::strip_acquisition({.block = block ? 1.5 : 0.0});
  std::vector<haptics::ForceSamples> contacts;
  for (const palpate::probing::Contact& contact : acquisition.contacts)
    contacts.push_back(haptics::realign(contact, acquisition.samples));
  const haptics::FitOptions options{
      .noise = {.displacement = haptics::pooled_displacement_noise(contacts)}};
  palpate::bench::run_paired(
      state,
      [&] {
        for (const haptics::ForceSamples& samples : contacts) {
          benchmark::DoNotOptimize(
              haptics::fit_force_field(samples.displacements, samples.forces, options));
        }
      },
      [&] {
        for (const haptics::ForceSamples& samples : contacts) {
          benchmark::DoNotOptimize(
              palpate::bench::exact_rbf(samples.displacements, samples.forces));
        }
      });
  state.counters["ms_per_contact"] =
      state.counters["ours_ms"] / static_cast<double>(contacts.size());
}
BENCHMARK_CAPTURE(fit_against_interpolation, sheet, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(fit_against_interpolation, sheet_with_block, true)->Unit(benchmark::kMillisecond);

}  // namespace
