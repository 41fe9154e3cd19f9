// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/command_line.h"

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "shared/field_options.h"

namespace palpate::apps {
namespace {

class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override {
    mode_ = mode;
    return CLI::Formatter::make_help(app, std::move(name), mode);
  }
  std::string make_group(std::string group, bool is_positional,
                         std::vector<const CLI::Option*> options) const override {
    if (group == kExpertOptions && mode_ == CLI::AppFormatMode::Normal) return {};
    return CLI::Formatter::make_group(std::move(group), is_positional, std::move(options));
  }
  std::string make_footer(const CLI::App* app) const override {
    const CLI::App* all = app;
    while (all->get_parent() != nullptr) all = all->get_parent();
    std::string shared;
    if (all != app) {
      const auto is_shared = [](const CLI::Option* option) {
        return option->get_group() == kSharedOptions;
      };
      shared = make_group(kSharedOptions, false, all->get_options(is_shared)).substr(1);
    }
    return shared + CLI::Formatter::make_footer(app);
  }

 private:
  mutable CLI::AppFormatMode mode_ = CLI::AppFormatMode::Normal;  ///< of the last help
};

}  // namespace

void print(const Settings& settings, const Json& figures, const std::string& prose) {
  // JSON must be UTF-8, but file names need not be.
  constexpr auto kReplace = Json::error_handler_t::replace;
  if (settings.figures != nullptr) {
    *settings.figures = figures;
    return;
  }
  if (settings.quiet && !settings.json) return;
  std::cout << (settings.json ? figures.dump(2, ' ', false, kReplace) : prose) << '\n';
}

Json number_or_null(std::optional<double> figure) { return figure ? Json(*figure) : Json(nullptr); }

Json numbers_in(const Eigen::Ref<const Eigen::VectorXd>& vector) {
  return std::vector<double>(vector.begin(), vector.end());
}

Json rows_in(const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
  Json rows = Json::array();
  for (const auto& row : matrix.rowwise()) rows.push_back(numbers_in(row.transpose()));
  return rows;
}

void add_unit_option(CLI::App& command, geometry::ReadOptions& options) {
  command.add_option_function<std::string>(
      "--unit", [&options](const std::string& name) { options.unit = geometry::unit_length(name); },
      "Unit of the coordinates in mesh files: um, mm, cm, m or in (default: as declared in the "
      "file, or mm)");
}

void show_shared_options(CLI::App& app) { app.formatter(std::make_shared<HelpFormatter>()); }

void refuse_empty_values(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    option->check([](const std::string& text) { return text.empty() ? "is empty" : std::string(); },
                  "");
  }
  for (CLI::App* command : app.get_subcommands({})) refuse_empty_values(*command);
}

}  // namespace palpate::apps
