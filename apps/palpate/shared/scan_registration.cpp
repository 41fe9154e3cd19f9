// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/scan_registration.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cstddef>

#include "palpate/core/error.h"
#include "shared/field_options.h"
#include "shared/progress.h"

namespace palpate::apps {

void add_scan_registration(CLI::App& command, const std::string& noun,
                           ScanRegistration& registration) {
  CLI::Option* here = command.add_flag(
      "--register", registration.wanted,
      fmt::format(
          "Register each {} rigidly to those before it, starting from its pose; fails (exit "
          "status 1) if no pose is reliable",
          noun));
  add_fields_of(*here, command, fields_of(registration.options));
}

Json register_named_scans(std::vector<geometry::Scan>& scans, const std::vector<std::string>& names,
                          const std::string& noun, const ScanRegistration& registration) {
  geometry::RegistrationOptions options = registration.options;
  options.progress = shown_as("registering");
  const std::vector<geometry::Registration> moves = geometry::register_scans(scans, options);
  Json figures = Json::array();
  for (std::size_t i = 0; i < moves.size(); ++i) {
    const std::string& name = names[i + 1];
    if (moves[i].verdict != geometry::RegistrationVerdict::accepted) {
      throw SolverError(fmt::format(
          "{} could not be registered to the {}s before it: {}: {}. Pass the poses with --pose and "
          "omit --register, or pass closer start poses with --pose and their uncertainty with "
          "--search-rotation and --search-translation.",
          name, noun, geometry::to_string(moves[i].verdict), moves[i].reason));
    }
    scans[i + 1].T_object_scan = moves[i].T_target_source;
    figures.push_back({{noun, name},
                       {"verdict", geometry::to_string(moves[i].verdict)},
                       {"reason", moves[i].reason},
                       {"rms", moves[i].rms},
                       {"overlap", moves[i].overlap}});
    spdlog::info("{} was registered: {}", name, moves[i].reason);
  }
  return figures;
}

}  // namespace palpate::apps
