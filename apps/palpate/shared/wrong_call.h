// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

namespace palpate::apps {

/// Explains why a call could not be parsed. For a word that is unknown, names the nearest command
/// or option.
[[nodiscard]] std::string describe_wrong_call(const CLI::App& app, const CLI::ParseError& error);

/// Finds the word of `words` from which `word` differs by the fewest typing errors: letters that
/// are missing, added, replaced or swapped.
/// \return nullopt if there are more than a third of its letters, or more than one in a short word.
[[nodiscard]] std::optional<std::string> nearest_word(const std::string& word,
                                                      const std::vector<std::string>& words);

}  // namespace palpate::apps
