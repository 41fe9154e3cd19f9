// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "reduce/simpler_fields.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "build/interpolated_as.h"
#include "palpate/core/parallel_for.h"
#include "palpate/haptics/force_field_fit.h"
#include "palpate/haptics/realignment.h"
#include "palpate/haptics/rounding.h"

namespace palpate::haptics {
namespace {

// Displacements of a tool that presses to these shares of the depth, and is then moved across by
// these multiples of how deep it is, in kDragDirections: what lies in the cones of usual friction.
constexpr std::array kDepths{0.15, 0.35, 0.6, 0.8, 1.0};
constexpr std::array kAcross{0.3, 0.7};
constexpr int kDragDirections = 8;

ForceSamples samples_of(const ForceField& field, double depth) {
  ForceSamples samples;
  constexpr auto kCount =
      static_cast<Eigen::Index>(kDepths.size() * (1 + kAcross.size() * kDragDirections));
  samples.displacements.resize(3, kCount);
  samples.forces.resize(3, kCount);
  Eigen::Index i = 0;
  for (const double share : kDepths) {
    const double z = share * depth;
    samples.displacements.col(i++) << 0, 0, z;
    for (const double across : kAcross) {
      for (int k = 0; k < kDragDirections; ++k) {
        const double angle = 2 * std::numbers::pi * k / kDragDirections;
        samples.displacements.col(i++) << across * z * std::cos(angle),
            across * z * std::sin(angle), z;
      }
    }
  }
  for (i = 0; i < kCount; ++i) samples.forces.col(i) = force(field, samples.displacements.col(i));
  return samples;
}

bool simplify(ContactModel& contact, double error, double depth) {
  const auto bases = static_cast<int>(contact.field.bases.size());
  if (bases <= 1) return false;
  const ForceSamples samples = samples_of(contact.field, depth);
  // The error counts as noise, so that bases leave as long as it explains what they change.
  FitOptions options{.mode = FitMode::convex,
                     .try_certified = false,
                     .max_bases = bases - 1,
                     .noise = {.displacement = 0, .force = error / std::sqrt(3.0)}};
  const FitResult fit = fit_force_field(samples.displacements, samples.forces, options);
  if (!(fit.rms <= error)) return false;
  contact.field = fit.field;
  contact.rms = std::hypot(contact.rms, fit.rms);
  contact.fit_mode = fit.mode;
  contact.fit_stop = fit.stop;
  contact.passivity = fit.certificate.passivity;
  contact.shared_local = false;
  contact.chi2.reset();
  contact.condition.reset();
  if (contact.uncertainty)
    contact.uncertainty->force = std::hypot(contact.uncertainty->force, fit.rms);
  contact = rounded(std::move(contact));
  return true;
}

// Compliances and strengths follow the new fields; their trends, learnt from more contacts, stay.
void renew_values(Model& model) {
  const Model learnt = interpolated_as(model, model.interpolation);
  for (std::size_t i = 0; i < model.contacts.size(); ++i) {
    ContactModel& contact = model.contacts[i];
    const ContactModel& now = learnt.contacts[i];
    if (contact.compliance && now.compliance) contact.compliance->values = now.compliance->values;
    if (contact.strength && now.strength) contact.strength->value = now.strength->value;
  }
}

}  // namespace

int simplify_fields(Model& model, double error, std::span<const double> depths,
                    std::span<double> too_small) {
  std::vector<char> replaced(model.contacts.size(), 0);
  parallel_for(replaced.size(), [&](std::size_t i) {
    if (!too_small.empty() && error <= too_small[i]) return;
    replaced[i] = simplify(model.contacts[i], error, depths[i]) ? 1 : 0;
    if (!too_small.empty() && replaced[i] == 0) too_small[i] = error;
  });
  const auto count = static_cast<int>(std::ranges::count(replaced, 1));
  if (count > 0) renew_values(model);
  return count;
}

}  // namespace palpate::haptics
