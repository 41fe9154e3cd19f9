// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"
#include "palpate/probing/contact_stiffness.h"
#include "palpate/probing/stiffness_map.h"
#include "probing/report_page.h"
#include "shared/command_line.h"

namespace palpate::apps {

/// The stiffness of an object as its presses show it.
struct ReportedStiffness {
  double force = 0;  ///< [N] of the presses that are compared
  std::vector<probing::ContactStiffness> contacts;
  probing::StiffnessMap map;
};

/// Nothing if fewer than eight contacts were pressed equally hard: they say little of what lies
/// between them.
[[nodiscard]] std::optional<ReportedStiffness> reported_stiffness(
    const probing::CheckedAcquisition& acquisition, const geometry::TriangleMesh& surface,
    const probing::PressNoise& noise);

/// The figures for `--json`; null if there is no map.
[[nodiscard]] Json stiffness_figures(const std::optional<ReportedStiffness>& stiffness);

inline constexpr const char* kStiffnessPicture = "stiffness.png";

/// Adds the map to a page, and draws it into `folder`.
void add_stiffness(ReportPage& page, const fs::path& folder, const geometry::TriangleMesh& surface,
                   const std::optional<ReportedStiffness>& stiffness);

}  // namespace palpate::apps
