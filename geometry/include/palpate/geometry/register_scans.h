// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "palpate/geometry/merge_scans.h"
#include "palpate/geometry/registration.h"

namespace palpate::geometry {

/// Moves scans of one object onto each other: the first stays where its pose puts it, each further
/// one is registered by its vertices, from where its pose puts it, onto all before it. At most
/// 20000 vertices of a scan are used, evenly.
///
/// Scans have to come in an order in which each overlaps those before it; `options.min_overlap` is
/// the part of its vertices that they saw too.
/// \return of each scan after the first how it moves, T_target_source its new T_object_scan. Ends
/// with the first that is not accepted: read the verdict of the last.
/// \throws InvalidInput if there is no scan, one is not valid (see `check_mesh`) or its pose is not
/// a rotation and a finite shift, or on an option out of range; the start in `options` is not used.
[[nodiscard]] std::vector<Registration> register_scans(std::span<const Scan> scans,
                                                       const RegistrationOptions& options = {});

}  // namespace palpate::geometry
