// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <Eigen/Core>
#include <numbers>
#include <optional>
#include <string>

#include "palpate/geometry/mesh_io.h"
#include "shared/aliases.h"

namespace palpate::apps {

/// [rad] Factor from degrees, used on the command line, to radians, used by the library.
constexpr double kDegree = std::numbers::pi / 180;

/// [mm] Smallest upper end of the colour scale in a picture of distances.
constexpr double kLeastScale = 1e-3;

/// Settings that all commands have.
struct Settings {
  bool json = false;   ///< print the figures as one JSON object instead of text
  bool quiet = false;  ///< print no text
  /// Destination of the figures if a command is a step of another one; then nothing is printed.
  Json* figures = nullptr;
};

/// Group of the options that all commands have, in their help.
constexpr const char* kSharedOptions = "Options of every command";

/// Prints a result: the figures as one JSON object, or the text.
void print(const Settings& settings, const Json& figures, const std::string& prose);

/// A figure in JSON; null if it is not known. Values that are not finite are null without this.
[[nodiscard]] Json number_or_null(std::optional<double> figure);

/// Returns the numbers of a vector, and those of a matrix row by row.
[[nodiscard]] Json numbers_in(const Eigen::Ref<const Eigen::VectorXd>& vector);
[[nodiscard]] Json rows_in(const Eigen::Ref<const Eigen::MatrixXd>& matrix);

/// Adds an argument or option that every call of the command must give.
template <typename Variable>
void add_required(CLI::App& command, const std::string& name, Variable& variable,
                  const std::string& help) {
  command.add_option(name, variable, help)->required();
}

/// Adds the option --unit, the unit of the coordinates in the mesh files that a command reads.
void add_unit_option(CLI::App& command, geometry::ReadOptions& options);

/// Lets the help of each command that is added later also list the options that all commands have.
void show_shared_options(CLI::App& app);

/// Rejects an empty value for every option of `app` and its subcommands. Otherwise an empty file
/// name would count as an option that was not given.
void refuse_empty_values(CLI::App& app);

// Each function adds a subcommand; its callback does the work and throws exceptions on failure.
void add_bake(CLI::App& app, const Settings& settings);
void add_cloud(CLI::App& app, const Settings& settings);
void add_compare(CLI::App& app, const Settings& settings);
void add_decode(CLI::App& app, const Settings& settings);
void add_demo(CLI::App& app, const Settings& settings);
void add_evaluate(CLI::App& app, const Settings& settings);
void add_export(CLI::App& app, const Settings& settings);
void add_fit(CLI::App& app, const Settings& settings);
void add_identify(CLI::App& app, const Settings& settings);
void add_info(CLI::App& app, const Settings& settings);
void add_fuse(CLI::App& app, const Settings& settings);
void add_merge(CLI::App& app, const Settings& settings);
void add_merge_shards(CLI::App& app, const Settings& settings);
void add_mesh(CLI::App& app, const Settings& settings);
void add_motion(CLI::App& app, const Settings& settings);
void add_path(CLI::App& app, const Settings& settings);
void add_pattern(CLI::App& app, const Settings& settings);
void add_plan(CLI::App& app, const Settings& settings);
void add_play(CLI::App& app, const Settings& settings);
void add_probe(CLI::App& app, const Settings& settings);
void add_reduce(CLI::App& app, const Settings& settings);
void add_run(CLI::App& app, const Settings& settings);
void add_simulate(CLI::App& app, const Settings& settings);
void add_track(CLI::App& app, const Settings& settings);
void add_trade(CLI::App& app, const Settings& settings);
void add_transfer(CLI::App& app, const Settings& settings);

// Each function adds one kind of calibration to `palpate calibrate`.
void add_calibrate_arm(CLI::App& calibrate, const Settings& settings);
void add_calibrate_chromatic(CLI::App& calibrate, const Settings& settings);
void add_calibrate_colors(CLI::App& calibrate, const Settings& settings);
void add_calibrate_crosstalk(CLI::App& calibrate, const Settings& settings);
void add_calibrate_response(CLI::App& calibrate, const Settings& settings);
void add_calibrate_rig(CLI::App& calibrate, const Settings& settings);

}  // namespace palpate::apps
