// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <Eigen/Core>

#include "palpate/probing/known_forces.h"
#include "palpate/probing/specimen.h"
#include "shared/command_line.h"

namespace palpate::apps {

// Each function adds subcommands to `palpate probe`.

/// `probe truth`: surface and known forces of a specimen.
void add_probe_truth(CLI::App& probe, const Settings& settings);
/// `probe plan`: places at which to probe a surface.
void add_probe_plan(CLI::App& probe, const Settings& settings);
/// `probe run`, `probe resume` and `probe status`: a campaign.
void add_probe_run(CLI::App& probe, const Settings& settings);
void add_probe_status(CLI::App& probe, const Settings& settings);
/// `probe report`: a page with tables and pictures of a campaign.
void add_probe_report(CLI::App& probe, const Settings& settings);

/// Adds the option `--sensor`, which sets a position [mm].
void add_sensor_option(CLI::App& command, Eigen::Vector3d& sensor);

/// Names of the files in a folder of `write_truth`.
inline constexpr const char* kTruthSurface = "surface.ply";
inline constexpr const char* kTruthQueries = "queries.csv";

/// Writes the surface of a simulated object and known forces on it.
/// \throws InvalidInput if no place is far enough from the border, SolverError if a force has no
/// equilibrium, or OutputError.
void write_truth(const fs::path& folder, const probing::Specimen& specimen,
                 const probing::KnownForceOptions& options = {});

}  // namespace palpate::apps
