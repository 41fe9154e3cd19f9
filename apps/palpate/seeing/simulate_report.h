// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "palpate/sensing/rig_assessment.h"

namespace palpate::apps {

/// Result of a trial of a rig.
struct ReportLine {
  sensing::RigAssessment found;
  std::string failure;            ///< why nothing was measured; else empty
  std::filesystem::path picture;  ///< empty if there is nothing to draw
};

/// Assesses the first body of a trial and draws its errors.
[[nodiscard]] ReportLine report_line(const std::filesystem::path& picture,
                                     const sensing::RigTrial& trial);

[[nodiscard]] nlohmann::ordered_json report_figures(const ReportLine& line);
[[nodiscard]] std::string report_table(const std::vector<ReportLine>& lines);

}  // namespace palpate::apps
