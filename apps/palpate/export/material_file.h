// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/aliases.h"

namespace palpate::apps {

/// Simulators whose input `write_material` writes.
[[nodiscard]] std::vector<std::string> simulators();

/// The ending of the input of one of `simulators`.
[[nodiscard]] std::string simulator_ending(const std::string& simulator);

/// Writes a solid with its material for a simulator, and the mesh that it loads beside it.
/// \returns what was written, in words.
std::string write_material(const fs::path& input, const std::string& simulator,
                           const fs::path& output);

}  // namespace palpate::apps
