// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "model/contact_places.h"

namespace palpate::haptics {

std::vector<geometry::SurfacePoint> contact_places(const Model& model,
                                                   const geometry::SurfaceQuery& surface) {
  std::vector<geometry::SurfacePoint> places;
  places.reserve(model.contacts.size());
  for (const ContactModel& contact : model.contacts)
    places.push_back(surface.closest_point(contact.position).at);
  return places;
}

}  // namespace palpate::haptics
