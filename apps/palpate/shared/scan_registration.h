// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "palpate/geometry/register_scans.h"
#include "shared/aliases.h"

namespace palpate::apps {

/// Options of the registration of views of an object to each other.
struct ScanRegistration {
  bool wanted = false;
  geometry::RegistrationOptions options;
};

/// Adds `--register` and the options of the search. `noun` is the command's word for a scan.
void add_scan_registration(CLI::App& command, const std::string& noun,
                           ScanRegistration& registration);

/// Registers each scan to those before it, starting from its pose, and sets its pose.
/// \return name (as `noun`), verdict, reason, rms and overlap of each scan but the first.
/// \throws SolverError naming the first scan whose pose is not accepted.
[[nodiscard]] Json register_named_scans(std::vector<geometry::Scan>& scans,
                                        const std::vector<std::string>& names,
                                        const std::string& noun,
                                        const ScanRegistration& registration);

}  // namespace palpate::apps
