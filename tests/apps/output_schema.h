// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace palpate::apps {

/// Returns the command of a call as docs/output.schema.json names it; nullopt if the call does not
/// request figures in JSON. `--json` of `palpate export` is the format of a file.
std::optional<std::string> command_with_figures(const std::vector<std::string>& call);

/// Returns the differences of `output` from the schema of the command; empty if there are none.
std::string differences_from_schema(const std::string& command, const std::string& output);

}  // namespace palpate::apps
