// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "palpate/geometry/surface_query.h"
#include "palpate/haptics/build_model.h"

namespace palpate::haptics {

/// Where contacts lie on the surface of `result.model`, which `query` asks. Registers the
/// acquisition to it if that is needed, and turns the surface over if it is seen from inside;
/// writes what it found into the result. Places name corners of triangles as they were before.
/// \throws InvalidInput if a contact is too far from the surface, or its normal points into it.
[[nodiscard]] std::vector<geometry::ClosestPoint> place_contacts(
    const std::vector<probing::Contact>& contacts, const geometry::SurfaceQuery& query,
    const BuildOptions& options, BuildResult& result);

}  // namespace palpate::haptics
