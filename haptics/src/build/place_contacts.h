// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "palpate/geometry/surface_query.h"
#include "palpate/haptics/build_model.h"

namespace palpate::haptics {

/// Finds the places of the contacts on the surface of `result.model`, which `query` searches.
/// Registers the acquisition to it if necessary, reverses the surface if it is seen from inside,
/// and records both in the result. Returned places refer to the triangles' corners before a
/// reversal.
/// \throws InvalidInput if a contact is too far from the surface, or its normal points into it.
[[nodiscard]] std::vector<geometry::ClosestPoint> place_contacts(
    const std::vector<probing::Contact>& contacts, const geometry::SurfaceQuery& query,
    const BuildOptions& options, BuildResult& result);

}  // namespace palpate::haptics
