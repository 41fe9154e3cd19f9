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

// Values of `ContactUncertainty::between` among which the most likely is chosen: 0, and kValues in
// equal ratios from the one that the mean square of the errors asks for down to this share of it.
constexpr double kLeastBetweenShare = 1e-4;
constexpr int kValues = 81;

// Of the force at the end of a stroke, for the same displacement.
struct EndError {
  double square = 0;  // [N^2] of the full model's error and the difference of the reduced
  double rest = 0;    // [N^2] that the reduced model states without what grows between contacts
  double unit = 0;    // [N^2] that this adds for `between` = 1
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
          .unit = parts.distance,
          .contacts = blend.contacts};
}

using WeightedErrors = std::vector<std::pair<double, const EndError*>>;

// -2 log likelihood of the errors, each counting by its weight.
double loss_of(const WeightedErrors& weighted, double between) {
  double loss = 0;
  for (const auto& [weight, error] : weighted) {
    const double stated = error->rest + between * between * error->unit;
    if (stated > 0)
      loss += weight * (std::log(stated) + error->square / stated);
    else if (error->square > 0)
      return std::numeric_limits<double>::infinity();
  }
  return loss;
}

// The value that explains the errors best; nothing if they do not depend on it.
std::optional<double> likeliest_between(const WeightedErrors& weighted) {
  // At most as much as the mean square of all errors asks for: few ends close to a contact, where
  // errors do not grow as assumed, must not count for those far away.
  double rest = 0, unit = 0;
  for (const auto& [weight, error] : weighted) {
    rest += weight * (error->square - error->rest);
    unit += weight * error->unit;
  }
  if (!(unit > 0)) return std::nullopt;
  const double largest = std::sqrt(std::max(0.0, rest) / unit);
  double best = largest, least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kValues; ++i) {
    const double value =
        i == kValues ? 0 : largest * std::pow(kLeastBetweenShare, i / (kValues - 1.0));
    const double loss = loss_of(weighted, value);
    if (loss < least) {
      least = loss;
      best = value;
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
  std::vector<WeightedErrors> of_contact(reduced.contacts.size());
  for (const EndError& error : errors) {
    for (std::size_t k = 0; k < static_cast<std::size_t>(error.contacts.count); ++k) {
      of_contact[static_cast<std::size_t>(error.contacts.contacts[k])].emplace_back(
          error.contacts.weights[k], &error);
    }
  }
  parallel_for(of_contact.size(), [&](std::size_t i) {
    ContactModel& contact = reduced.contacts[i];
    if (const std::optional<double> between = likeliest_between(of_contact[i]))
      contact.uncertainty->between = *between;
    contact = rounded(std::move(contact));
  });
}

}  // namespace palpate::haptics
