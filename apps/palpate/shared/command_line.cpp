// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/command_line.h"

#include <iostream>
#include <nlohmann/json.hpp>

namespace palpate::apps {

void print(const Settings& settings, const nlohmann::ordered_json& figures,
           const std::string& prose) {
  // JSON must be UTF-8, but file names need not be.
  constexpr auto kReplace = nlohmann::ordered_json::error_handler_t::replace;
  std::cout << (settings.json ? figures.dump(2, ' ', false, kReplace) : prose) << '\n';
}

nlohmann::ordered_json number_or_null(std::optional<double> figure) {
  return figure ? nlohmann::ordered_json(*figure) : nlohmann::ordered_json(nullptr);
}

void add_unit_option(CLI::App& command, geometry::ReadOptions& options) {
  command.add_option_function<std::string>(
      "--unit", [&options](const std::string& name) { options.unit = geometry::unit_length(name); },
      "Unit of the coordinates in mesh files: um, mm, cm, m or in (default: as declared in the "
      "file, or mm)");
}

void refuse_empty_values(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    option->check([](const std::string& text) { return text.empty() ? "is empty" : std::string(); },
                  "");
  }
  for (CLI::App* command : app.get_subcommands({})) refuse_empty_values(*command);
}

}  // namespace palpate::apps
