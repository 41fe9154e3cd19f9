// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shards/shard.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <string_view>
#include <system_error>

#include "palpate/core/file_fingerprint.h"
#include "shared/call_checks.h"

namespace palpate::apps {
namespace {

constexpr const char* kShardOption = "--shard";

/// Nothing unless the text is i/n with 1 <= i <= n.
std::optional<Shard> shard_of(const std::string& text) {
  const auto pair = pair_of(text, '/');
  if (!pair || pair->first < 1 || pair->first > pair->second) return std::nullopt;
  return Shard{.index = pair->first, .count = pair->second};
}

std::string in_shell(const std::string& word) {
  constexpr std::string_view kPlain = "-_./=,:+@%";
  const bool is_plain = std::ranges::all_of(word, [&](unsigned char c) {
    return std::isalnum(c) != 0 || kPlain.find(static_cast<char>(c)) != std::string_view::npos;
  });
  if (is_plain && !word.empty()) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

/// The words of an option and its values, or of arguments without a name.
std::string in_shell(const CLI::Option& option) {
  std::string words = option.get_positional() ? "" : " " + option.get_name();
  if (option.get_items_expected_max() == 0) return words;  // a flag
  const char delimiter = option.get_delimiter();
  for (bool first = true; const std::string& value : option.results()) {
    words += (first || delimiter == '\0' ? ' ' : delimiter) + in_shell(value);
    first = false;
  }
  return words;
}

/// The values of an option, with the fingerprint of a file in place of its name.
Json values_of(const CLI::Option& option) {
  Json values = Json::array();
  for (const std::string& value : option.results()) {
    std::error_code ignored;
    values.push_back(fs::is_regular_file(value, ignored) ? file_fingerprint(value) : value);
  }
  return values;
}

/// The options that were given, without those that only say which items, where to, and how many.
std::vector<const CLI::Option*> given_options(const CLI::App& command) {
  std::vector<const CLI::Option*> given;
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() > 0 && option->get_name() != kShardOption) given.push_back(option);
  }
  std::stable_partition(given.begin(), given.end(),
                        [](const auto* option) { return option->get_positional(); });
  return given;
}

}  // namespace

std::string to_string(const Shard& shard) { return fmt::format("{}/{}", shard.index, shard.count); }

ShardBlock block_of(const Shard& shard, std::size_t items) {
  const auto border = [&](int index) {
    return static_cast<std::size_t>(static_cast<std::uint64_t>(items) *
                                    static_cast<std::uint64_t>(index) /
                                    static_cast<std::uint64_t>(shard.count));
  };
  return {border(shard.index - 1), border(shard.index)};
}

CLI::Option* add_shard_option(CLI::App& command, std::optional<Shard>& shard) {
  return command
      .add_option_function<std::string>(
          kShardOption, [&shard](const std::string& text) { shard = shard_of(text); },
          "Do only part i of n, i/n such as 3/7, so that several processes share the work; palpate "
          "merge-shards puts the parts together (docs/clusters.md)")
      ->check(CLI::Validator(
          [](const std::string& text) {
            return shard_of(text) ? std::string()
                                  : "is " + text +
                                        "; it must be i/n with 1 <= i <= n, such as 3/7 for the "
                                        "third of seven parts";
          },
          ""));
}

ShardCall shard_call(const CLI::App& command, const fs::path& output, const Shard& shard,
                     std::span<const fs::path> items) {
  std::string names;
  for (const fs::path& item : items) names += item.filename().string() + '\n';
  ShardCall call{.command = command.get_name(),
                 .words = "palpate " + command.get_name(),
                 .directory = fs::current_path(),
                 .output = output,
                 .settings = {{"version", PALPATE_VERSION},
                              {"number of shards", shard.count},
                              {"number of items", items.size()},
                              {"list of items", text_fingerprint(names)}}};
  for (const CLI::Option* option : given_options(command)) {
    call.words += in_shell(*option);
    const bool is_place = option->get_positional() || option->check_name("--output");
    if (!is_place) call.settings[option->get_name()] = values_of(*option);
  }
  return call;
}

std::string words_of(const ShardCall& call, const Shard& shard) {
  return call.words + " --shard " + to_string(shard);
}

}  // namespace palpate::apps
