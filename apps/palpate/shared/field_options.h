// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/fields.h"
#include "shared/aliases.h"

namespace palpate::apps {

/// Group of the options that few users set: --help-all shows them, --help does not.
constexpr const char* kExpertOptions = "Expert options";

/// Adds an option for each field of a list: --min-signal for `min_signal`, with the range of the
/// list. Angles [rad] are given in degrees. The struct must live as long as the command.
/// \param only names of the fields that the command takes; empty: all
/// \return the options, in the order of the fields.
std::vector<CLI::Option*> add_fields(CLI::App& command, const FieldList& fields,
                                     std::span<const std::string_view> only = {});

/// The same for fields that have an effect with a flag alone: help lists them after "With --align".
void add_fields_of(CLI::Option& flag, CLI::App& command, const FieldList& fields);

/// Accepts the values of one field of a list. The message is '--plane: is "0"; it must be a number
/// > 0'. The struct must live as long as the validator.
[[nodiscard]] CLI::Validator value_of_field(const FieldList& fields, const std::string& name);

/// The values of all fields by their options, for the records of runs.
[[nodiscard]] Json option_values(const FieldList& fields);

/// The options of a call that gives `fields` where they differ from `usual`, another list of the
/// same struct: " --window-periods 3 --half-resolution".
[[nodiscard]] std::string changed_options(const FieldList& fields, const FieldList& usual);

/// The option of a field: "--min-signal" for "min_signal".
[[nodiscard]] std::string option_name(std::string_view field);

/// The option of a field with its struct as its list names it: "--remesh" for
/// "RemeshingOptions::edge_length", "--no-slip" for a flag that is true by default. Other names
/// stay.
[[nodiscard]] std::string field_option(const std::string& name);

/// The message of an error with these names in place of functions ("build_model()") and fields of
/// the library, and options in place of all other fields.
[[nodiscard]] std::string with_names(const InvalidInput& error,
                                     const std::map<std::string, std::string>& names);

/// Returns the result of `task`; its errors have these names.
template <typename Task>
auto with_names(const std::map<std::string, std::string>& names, Task task) {
  try {
    return task();
  } catch (const InvalidInput& error) {
    throw InvalidInput(with_names(error, names));
  }
}

/// The message of an error, with the options of the command that was called in place of the fields
/// of the library.
[[nodiscard]] std::string with_option_names(const InvalidInput& error, const CLI::App& app);

}  // namespace palpate::apps
