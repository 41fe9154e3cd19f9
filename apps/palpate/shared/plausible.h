// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "palpate/geometry/triangle_mesh.h"
#include "palpate/probing/acquisition.h"
#include "palpate/probing/contact_surface.h"
#include "shared/aliases.h"

namespace palpate::apps {

/// Prints a warning on standard error, and adds it to the list `warnings` of a command's figures:
/// {"kind": ..., "message": ...}.
void warn(Json& warnings, const std::string& kind, const std::string& message);

/// Warns of suspicious measurements.
/// \throws InvalidInput if they cannot be measurements of an object, naming `source`.
void check_plausible(const std::string& source, const probing::CheckedAcquisition& acquisition,
                     Json& warnings);

/// Returns a surface of only the contacts (`probing::contact_surface`). Warns of contacts that it
/// leaves out.
/// \throws InvalidInput that begins with `source` if there is no such surface.
[[nodiscard]] geometry::TriangleMesh surface_of_contacts(
    const probing::CheckedAcquisition& acquisition, const std::string& source, Json& warnings,
    probing::ContactSurfaceOptions options = {});

/// Reads and checks a store.
/// \throws FileError, or InvalidInput if it cannot hold measurements of an object.
[[nodiscard]] probing::CheckedAcquisition read_plausible_acquisition(const fs::path& store,
                                                                     Json& warnings);

}  // namespace palpate::apps
