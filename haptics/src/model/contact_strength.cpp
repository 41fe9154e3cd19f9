// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/contact_strength.h"

#include <algorithm>
#include <utility>

#include "model/compliance_kriging.h"
#include "palpate/core/parallel_for.h"
#include "palpate/core/require.h"
#include "palpate/haptics/rounding.h"

namespace palpate::haptics {

Model with_strengths(Model model, double reference_depth) {
  require("with_strengths(): reference_depth", reference_depth, above(0).finite(), "mm");
  check_model(model);
  for (ContactModel& contact : model.contacts) {
    // An energy that is not convex may fall below that at zero.
    const double work = std::max(potential(contact.field, {0, 0, reference_depth}), 0.0);
    contact.strength = {.value = round_to_digits(work / reference_depth, kFieldDigits)};
    contact.compliance.reset();
  }
  model.interpolation = {.rule = BlendRule::forces, .reference_depth = reference_depth};
  const ComplianceKriging kriging = learn_kriging(model);
  model.interpolation.reach = kReachRatio * kriging.spacing;
  parallel_for(kriging.known.size(), [&](std::size_t i) {
    ContactModel& contact = model.contacts[static_cast<std::size_t>(kriging.known[i])];
    contact.strength->trend =
        kriging_trend(kriging.around[i], *kriged_value(contact, BlendRule::forces),
                      kriging.covariance)
            .row(2)
            .transpose()
            .unaryExpr([](double value) { return round_to_digits(value, kTrendDigits); });
  });
  return model;
}

}  // namespace palpate::haptics
