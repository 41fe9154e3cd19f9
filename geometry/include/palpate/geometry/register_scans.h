// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "palpate/geometry/merge_scans.h"
#include "palpate/geometry/registration.h"

namespace palpate::geometry {

/// Points of a mesh to be registered to another: its vertices, without those that no triangle uses;
/// of more than 20000, that many, evenly chosen. They determine a pose far better than needed.
/// \return 3 x N [mm]
/// \pre the mesh is valid.
[[nodiscard]] Eigen::Matrix3Xd registration_points(const TriangleMesh& mesh);

/// Registers scans of one object with each other. The first scan stays at its pose. The points of
/// each further scan (`registration_points`) are registered, starting from its pose, to the surface
/// of all scans before it.
///
/// The order must be such that each scan overlaps those before it; `options.min_overlap` is the
/// share of its vertices that those also see.
/// \return for each scan after the first its registration, where T_target_source is the new
/// T_object_scan. Ends with the first one that is not accepted, so check the verdict of the last.
/// \throws InvalidInput if there is no scan, a scan is not valid (see `check_mesh`), a pose is not
/// rigid and finite, or an option is outside its range. The start in `options` is not used.
[[nodiscard]] std::vector<Registration> register_scans(std::span<const Scan> scans,
                                                       const RegistrationOptions& options = {});

}  // namespace palpate::geometry
