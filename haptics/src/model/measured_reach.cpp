// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "model/measured_reach.h"

#include <cmath>
#include <utility>
#include <vector>

#include "palpate/core/quantile.h"

namespace palpate::haptics {
namespace {

// Relative to the diagonal of the surface.
constexpr double kAssumedDepth = 0.1;

// The median of positive numbers; `otherwise` if there is none.
double median_or(std::vector<double> values, double otherwise) {
  std::erase_if(values, [](double value) { return !(value > 0 && std::isfinite(value)); });
  return values.empty() ? otherwise : median(values);
}

}  // namespace

MeasuredReach measured_reach(const Model& model) {
  const double assumed = kAssumedDepth * geometry::bounding_diagonal(model.surface);
  const Interpolation& measured = model.interpolation;
  std::vector<double> values;
  if (measured.reference_force > 0) {
    for (const ContactModel& contact : model.contacts)
      if (contact.compliance) values.push_back(contact.compliance->values(2));
    return {.force = measured.reference_force, .depth = median_or(std::move(values), assumed)};
  }
  const double depth = measured.reference_depth > 0 ? measured.reference_depth : assumed;
  for (const ContactModel& contact : model.contacts)
    values.push_back(force(contact.field, {0, 0, depth}).norm());
  return {.force = median_or(std::move(values), 1), .depth = depth};
}

}  // namespace palpate::haptics
