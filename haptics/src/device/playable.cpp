// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/playable.h"

#include <fmt/format.h>

#include <string>

#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "palpate/geometry/surface_query.h"

namespace palpate::haptics {

void check_playable(const Model& model, const PlayableOptions& options) {
  require("PlayableOptions::off_surface", options.off_surface, above(0).finite(), "mm");
  check_model(model);
  const geometry::SurfaceQuery surface(model.surface);
  for (const ContactModel& contact : model.contacts) {
    const std::string name = "contact " + std::to_string(contact.id);
    const double distance = surface.closest_point(contact.position).distance;
    if (!(distance <= options.off_surface)) {
      throw InvalidInput(fmt::format(
          "{} lies {:g} mm off the surface; contacts lie on it, to {:g} mm: the surface "
          "may be another one, or in another unit",
          name, distance, options.off_surface));
    }
    if (contact.field.bases.size() > options.most_bases) {
      throw InvalidInput(name + " has " + std::to_string(contact.field.bases.size()) +
                         " bases; with more than " + std::to_string(options.most_bases) +
                         " the loop does not keep 1 kHz: fit it with fewer ('palpate fit "
                         "--max-bases')");
    }
  }
}

}  // namespace palpate::haptics
