// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <Eigen/Core>

#include "shared/command_line.h"

namespace palpate::apps {

// Each function adds subcommands to `palpate probe`.

/// `probe truth`: surface and known forces of a specimen.
void add_probe_truth(CLI::App& probe, const Settings& settings);
/// `probe plan`: where to probe a surface.
/// Adds the option `--sensor`, which sets a position [mm].
void add_sensor_option(CLI::App& command, Eigen::Vector3d& sensor);

void add_probe_plan(CLI::App& probe, const Settings& settings);
/// `probe run`, `probe resume` and `probe status`: a campaign.
void add_probe_run(CLI::App& probe, const Settings& settings);
void add_probe_status(CLI::App& probe, const Settings& settings);
/// `probe report`: a page with tables and pictures of a campaign.
void add_probe_report(CLI::App& probe, const Settings& settings);

}  // namespace palpate::apps
