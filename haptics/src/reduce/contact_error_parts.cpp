// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "reduce/contact_error_parts.h"

#include <algorithm>
#include <cmath>

#include "model/fit_misfit.h"

namespace palpate::haptics {
namespace {

// [N^2] The part of a contact's error that its fit explains by the noise of the forces.
double noise_square(const Model& model, const ContactModel& contact) {
  const double square = std::pow(contact.uncertainty->force, 2);
  if (!model.noise || !contact.chi2 || !contact.noise_floor || contact.samples == 0) return 0;
  return std::max(0.0, square - fit_misfit(*contact.chi2, *contact.noise_floor, contact.samples));
}

}  // namespace

ContactErrorParts contact_error_parts(const Model& model) {
  ContactErrorParts parts{model.contacts, model.contacts, model.contacts, model.contacts};
  for (std::size_t i = 0; i < model.contacts.size(); ++i) {
    const std::optional<ContactUncertainty>& own = model.contacts[i].uncertainty;
    if (!own) continue;
    const double noise = noise_square(model, model.contacts[i]);
    parts.force_noise[i].uncertainty = {.force = std::sqrt(noise)};
    parts.position_noise[i].uncertainty = {.displacement = own->displacement};
    parts.fit[i].uncertainty = {.force = std::sqrt(own->force * own->force - noise)};
    parts.across[i].uncertainty = {.across = own->across};
  }
  return parts;
}

}  // namespace palpate::haptics
