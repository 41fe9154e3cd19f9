// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "palpate/geometry/surface_query.h"
#include "palpate/haptics/build_model.h"

namespace palpate::haptics {

/// Contacts that fit the surface.
struct PlacedContacts {
  std::vector<std::size_t> kept;               ///< indices of the contacts, ascending
  std::vector<geometry::ClosestPoint> places;  ///< of those
};

/// Finds the places of the contacts on the surface of `result.model`, which `query` searches.
/// Registers the acquisition to it if necessary, reverses the surface if it is seen from inside,
/// leaves out contacts that do not fit, and records all this in the result. Returned places refer
/// to the triangles' corners before a reversal.
/// \throws InvalidInput if more contacts than allowed are too far from the surface, or have a normal
/// that points into it, or if fewer than three remain.
[[nodiscard]] PlacedContacts place_contacts(const std::vector<probing::Contact>& contacts,
                                            const geometry::SurfaceQuery& query,
                                            const BuildOptions& options, BuildResult& result);

}  // namespace palpate::haptics
