// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/wrong_call.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>

namespace palpate::apps {
namespace {

/// Number of typing errors between two words.
std::size_t typing_errors(const std::string& a, const std::string& b) {
  // errors[i][j]: between the first i letters of a and the first j of b.
  std::vector<std::vector<std::size_t>> errors(a.size() + 1,
                                               std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) {
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        errors[i][j] = i + j;
        continue;
      }
      errors[i][j] = std::min({errors[i - 1][j] + 1, errors[i][j - 1] + 1,
                               errors[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        errors[i][j] = std::min(errors[i][j], errors[i - 2][j - 2] + 1);
    }
  }
  return errors[a.size()][b.size()];
}

/// The innermost subcommand that the call names.
const CLI::App& named_command(const CLI::App& app) {
  const std::vector<CLI::App*> named = app.get_subcommands();
  return named.empty() ? app : named_command(*named.front());
}

/// "palpate calibrate rig"
std::string whole_name(const CLI::App& command) {
  const CLI::App* parent = command.get_parent();
  return (parent != nullptr ? whole_name(*parent) + " " : "") + command.get_name();
}

std::vector<std::string> subcommands(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::App* sub : command.get_subcommands([](const CLI::App*) { return true; }))
    if (!sub->get_name().empty()) names.push_back(sub->get_name());
  return names;
}

/// The long names of all options that the command takes.
std::vector<std::string> options(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options([](const CLI::Option*) { return true; }))
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  for (const CLI::App* group : command.get_subcommands([](const CLI::App*) { return true; })) {
    if (!group->get_name().empty()) continue;  // not a group of options
    for (std::string& name : options(*group)) names.push_back(std::move(name));
  }
  return names;
}

std::string describe_option(const CLI::App& command, const std::string& given) {
  const std::string word = given.substr(0, given.find('='));
  std::vector<std::string> known;
  for (const CLI::App* app = &command; app != nullptr; app = app->get_parent())
    for (std::string& name : options(*app)) known.push_back(std::move(name));
  const std::optional<std::string> nearest = nearest_word(word, known);
  return fmt::format("unknown option '{}' of {}{}", word, whole_name(command),
                     nearest ? "; did you mean " + *nearest + "?" : ".");
}

std::string describe_command(const CLI::App& command, const std::vector<std::string>& words) {
  const std::vector<std::string> known = subcommands(command);
  const std::string all = fmt::format("{}", fmt::join(known, ", "));
  if (words.empty()) return whole_name(command) + " needs a command: " + all + ".";
  const std::optional<std::string> nearest = nearest_word(words.front(), known);
  return fmt::format("unknown command '{}' of {}; {}", words.front(), whole_name(command),
                     nearest ? "did you mean " + *nearest + "?" : "the commands are " + all + ".");
}

/// States that an option with a fixed number of values has too few; empty for another error.
std::string describe_missing_values(const CLI::App& command, const CLI::ParseError& error) {
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) == nullptr) return {};
  const std::string text = error.what();
  const CLI::Option* option = command.get_option_no_throw(text.substr(0, text.find(':')));
  if (option == nullptr || option->get_items_expected_min() < 2) return {};
  if (option->get_items_expected_min() != option->get_items_expected_max()) return {};
  return fmt::format("{}: needs {} values ({})", option->get_name(),
                     option->get_items_expected_min(), option->get_description());
}

std::string describe(const CLI::App& app, const CLI::App& command, const CLI::ParseError& error) {
  const std::string missing = describe_missing_values(command, error);
  if (!missing.empty()) return missing;
  const std::vector<std::string> words = app.remaining(true);
  const auto option = std::ranges::find_if(
      words, [](const std::string& word) { return word.starts_with("--") && word.size() > 2; });
  if (option != words.end()) return describe_option(command, *option);
  if (!subcommands(command).empty()) return describe_command(command, words);
  if (!words.empty()) return words.front() + ": is not expected in this call.";
  return error.what();
}

}  // namespace

std::optional<std::string> nearest_word(const std::string& word,
                                        const std::vector<std::string>& words) {
  if (words.empty()) return std::nullopt;
  const auto nearest = std::ranges::min_element(
      words, {}, [&](const std::string& known) { return typing_errors(word, known); });
  const std::size_t most = std::max<std::size_t>(1, word.size() / 3);
  if (typing_errors(word, *nearest) > most) return std::nullopt;
  return *nearest;
}

std::string describe_wrong_call(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App& command = named_command(app);
  std::string what = describe(app, command, error);
  if (!what.ends_with('.') && !what.ends_with('?')) what += '.';
  return what + " Help: " + whole_name(command) + " --help";
}

}  // namespace palpate::apps
