// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include "shared/command_line.h"

namespace palpate::apps {

/// Adds all subcommands of `palpate` to a new `app`, with the rules for their options. `settings`
/// must outlive it.
void add_commands(CLI::App& app, const Settings& settings);

}  // namespace palpate::apps
