// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include "shared/aliases.h"

namespace palpate::apps {

/// What `palpate --help-all --json` prints: a command with its options, and in "commands" those
/// below it in the same form. Manual pages and completions are made of it.
[[nodiscard]] Json describe_commands(const CLI::App& command);

}  // namespace palpate::apps
