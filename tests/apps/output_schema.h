// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace palpate::apps {

/// The command of a call as docs/output.schema.json names it; none if the call does not ask for
/// figures in JSON. `--json` of `palpate export` is the format of a file.
std::optional<std::string> command_with_figures(const std::vector<std::string>& call);

/// How `output` differs from the schema of the command; empty if it does not.
std::string differences_from_schema(const std::string& command, const std::string& output);

}  // namespace palpate::apps
