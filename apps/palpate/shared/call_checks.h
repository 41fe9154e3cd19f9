// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "palpate/core/require.h"

namespace palpate::apps {

/// Accepts the numbers of a range, and no NaN. The message is that of `require`, after the name of
/// the option: "--tolerance: is -1; it must be > 0".
[[nodiscard]] CLI::Validator within(const Interval& range);

/// Accepts one of some words. The message is "--format: is stp; it must be ply, obj or stl".
[[nodiscard]] CLI::Validator one_of(const std::vector<std::string>& words);

/// Returns the numbers of a list "1,2.5"; nullopt if one is not a number, or not finite.
[[nodiscard]] std::optional<std::vector<double>> numbers_of(const std::string& text);

/// Returns the two integers of "8x11" or "3/7", with this sign between them; nullopt for others.
[[nodiscard]] std::optional<std::pair<int, int>> pair_of(const std::string& text, char between);

/// Accepts lists of numbers for which `is_right` returns true. The message is "--crop: is 1,2; it
/// must be " and `what`.
[[nodiscard]] CLI::Validator list_of_numbers(
    std::function<bool(const std::vector<double>&)> is_right, const std::string& what);

/// Adds an option that is a number in a range, or several such numbers.
template <typename Variable>
CLI::Option* add_number(CLI::App& app, const std::string& name, Variable& variable,
                        const Interval& range, const std::string& help) {
  return app.add_option(name, variable, help)->check(within(range));
}

/// Adds an option that is one of some words.
template <typename Variable>
CLI::Option* add_word(CLI::App& app, const std::string& name, Variable& variable,
                      const std::vector<std::string>& words, const std::string& help) {
  return app.add_option(name, variable, help)->check(one_of(words));
}

/// Adds an option whose words stand for values.
template <typename Value, typename Variable>
CLI::Option* add_choice(CLI::App& app, const std::string& name, Variable& variable,
                        const std::vector<std::pair<std::string, Value>>& choices,
                        const std::string& help) {
  std::vector<std::string> words;
  words.reserve(choices.size());
  for (const auto& [word, value] : choices) words.push_back(word);
  return app
      .add_option_function<std::string>(
          name,
          [&variable, choices](const std::string& chosen) {
            for (const auto& [word, value] : choices) {
              if (word == chosen) variable = value;
            }
          },
          help)
      ->check(one_of(words));
}

}  // namespace palpate::apps
