// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json_fwd.hpp>
#include <numbers>
#include <string>

#include "palpate/geometry/mesh_io.h"

namespace palpate::apps {

/// [rad] What is said in degrees on the command line, times this, is what the library takes.
constexpr double kDegree = std::numbers::pi / 180;

/// What every command understands.
struct Settings {
  bool json = false;  ///< print one JSON object with the figures instead of prose
};

/// Prints a result: the figures as one JSON object, or the prose.
void print(const Settings& settings, const nlohmann::ordered_json& figures,
           const std::string& prose);

/// Adds --unit: what one unit of the coordinates is in the meshes that a command reads.
void add_unit_option(CLI::App& command, geometry::ReadOptions& options);

/// Accepts numbers above 0, or at least 0, and no NaN.
[[nodiscard]] CLI::Validator positive();
[[nodiscard]] CLI::Validator not_negative();

/// Makes an empty text a wrong value of every option of `app` and its subcommands: as the name of a
/// file it would mean nothing, or the option left out.
void refuse_empty_values(CLI::App& app);

// Each adds one subcommand, whose callback does the work and throws what goes wrong.
void add_calibrate(CLI::App& app, const Settings& settings);
void add_compare(CLI::App& app, const Settings& settings);
void add_decode(CLI::App& app, const Settings& settings);
void add_demo(CLI::App& app, const Settings& settings);
void add_evaluate(CLI::App& app, const Settings& settings);
void add_export(CLI::App& app, const Settings& settings);
void add_fit(CLI::App& app, const Settings& settings);
void add_identify(CLI::App& app, const Settings& settings);
void add_info(CLI::App& app, const Settings& settings);
void add_merge(CLI::App& app, const Settings& settings);
void add_mesh(CLI::App& app, const Settings& settings);
void add_pattern(CLI::App& app, const Settings& settings);
void add_play(CLI::App& app, const Settings& settings);
void add_probe(CLI::App& app, const Settings& settings);
void add_simulate(CLI::App& app, const Settings& settings);
void add_transfer(CLI::App& app, const Settings& settings);

}  // namespace palpate::apps
