// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "reduce/reduced_uncertainty.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "model/force_variance.h"
#include "palpate/core/parallel_for.h"
#include "palpate/haptics/blended_field.h"
#include "palpate/haptics/rounding.h"

namespace palpate::haptics {
namespace {

// Factors of `ContactUncertainty::between` among which the most likely is chosen: between 1 /
// kMostFactor and kMostFactor, in equal ratios.
constexpr double kMostFactor = 30;
constexpr int kFactors = 81;

// Of the force at the end of a stroke, for the same displacement.
struct EndError {
  double square = 0;  // [N^2] of the full model's error and the difference of the reduced
  double rest = 0, between = 0;  // [N^2] that the reduced model states, and the part to scale
  geometry::ContactWeights contacts;
};

EndError error_at(const StrokeEnd& end, const Model& full, const BlendedField& full_field,
                  const Model& reduced, const BlendedField& field) {
  const geometry::ClosestPoint there = full_field.surface().closest_point(end.contact),
                               here = field.surface().closest_point(end.contact);
  const Eigen::Vector3d displacement = end.tool - end.contact;
  const Blend full_blend = full_field.blend(there.at), blend = field.blend(here.at);
  const ForceVariance own = force_variance(full.contacts, full_blend, there.position, displacement);
  const ForceVariance parts = force_variance(reduced.contacts, blend, here.position, displacement);
  const double difference =
      (full_field.force(full_blend, displacement) - field.force(blend, displacement)).squaredNorm();
  return {.square = own.contacts + own.contrast + own.between * own.distance + difference,
          .rest = parts.contacts + parts.contrast,
          .between = parts.between * parts.distance,
          .contacts = blend.contacts};
}

// The factor with which the stated errors explain the squares best, each counting by its weight.
double likeliest_factor(const std::vector<std::pair<double, const EndError*>>& weighted) {
  double best = 1, least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kFactors; ++i) {
    const double factor = std::pow(kMostFactor, 2 * i / (kFactors - 1.0) - 1);
    double loss = 0;
    for (const auto& [weight, error] : weighted) {
      const double stated = error->rest + factor * factor * error->between;
      if (stated > 0) loss += weight * (std::log(stated) + error->square / stated);
    }
    if (loss < least) {
      least = loss;
      best = factor;
    }
  }
  return best;
}

bool states_errors(const Model& model) {
  return std::ranges::all_of(model.contacts,
                             [](const ContactModel& of) { return of.uncertainty.has_value(); });
}

}  // namespace

std::optional<double> stated_error(const Model& model, std::span<const StrokeEnd> ends) {
  if (!states_errors(model)) return std::nullopt;
  const BlendedField field(model);
  double sum = 0;
  for (const StrokeEnd& end : ends)
    sum += std::pow(field.deviation(end.contact, end.tool - end.contact).value_or(0), 2);
  return std::sqrt(sum / static_cast<double>(ends.size()));
}

void state_reduced_errors(const Model& full, std::span<const StrokeEnd> ends, Model& reduced) {
  if (!states_errors(full)) return;
  const BlendedField full_field(full), field(reduced);
  std::vector<EndError> errors(ends.size());
  parallel_for(ends.size(), [&](std::size_t i) {
    errors[i] = error_at(ends[i], full, full_field, reduced, field);
  });
  std::vector<std::vector<std::pair<double, const EndError*>>> of_contact(reduced.contacts.size());
  for (const EndError& error : errors) {
    for (std::size_t k = 0; k < static_cast<std::size_t>(error.contacts.count); ++k) {
      of_contact[static_cast<std::size_t>(error.contacts.contacts[k])].emplace_back(
          error.contacts.weights[k], &error);
    }
  }
  parallel_for(of_contact.size(), [&](std::size_t i) {
    ContactModel& contact = reduced.contacts[i];
    contact.uncertainty->between *= likeliest_factor(of_contact[i]);
    contact = rounded(std::move(contact));
  });
}

}  // namespace palpate::haptics
