// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "palpate/sensing/rig_assessment.h"
#include "shared/command_line.h"

namespace palpate::apps {

/// Result of a trial of a rig.
struct ReportLine {
  sensing::RigAssessment found;
  std::string failure;  ///< why nothing was measured; else empty
  fs::path picture;     ///< empty if there is nothing to draw
};

/// Assesses the first body of a trial and draws its errors.
[[nodiscard]] ReportLine report_line(const fs::path& picture, const sensing::RigTrial& trial);

/// Prints the results of a simulation.
/// \param lines of the report; empty if there is none.
/// \param images of each shot: 1, or those of a still scene.
void print_simulated(const Settings& settings, const std::vector<ReportLine>& lines,
                     std::size_t shots, std::size_t images, const fs::path& output);

}  // namespace palpate::apps
