// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "whole/describe_commands.h"

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace palpate::apps {
namespace {

Json describe_option(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  if (option.get_positional()) names = {option.get_name(true)};
  Json described = {{"names", names},
                    {"meaning", option.get_description()},
                    {"group", option.get_group()},
                    {"positional", option.get_positional()},
                    {"required", option.get_required()},
                    {"values", option.get_items_expected_max()}};
  // A flag has a type too, that of the variable it sets.
  if (option.get_items_expected_max() > 0) described["type"] = option.get_type_name();
  if (!option.get_default_str().empty()) described["default"] = option.get_default_str();
  return described;
}

/// A group of options is, to CLI11, a command without a name.
void describe_options(const CLI::App& command, Json& described) {
  for (const CLI::Option* option : command.get_options()) {
    if (!option->get_group().empty()) described.push_back(describe_option(*option));
  }
  for (const CLI::App* group :
       command.get_subcommands([](const CLI::App* part) { return part->get_name().empty(); }))
    describe_options(*group, described);
}

}  // namespace

Json describe_commands(const CLI::App& command) {
  Json described = {{"name", command.get_name()},   {"meaning", command.get_description()},
                    {"group", command.get_group()}, {"more", command.get_footer()},
                    {"options", Json::array()},     {"commands", Json::array()}};
  describe_options(command, described["options"]);
  for (const CLI::App* part :
       command.get_subcommands([](const CLI::App* part) { return !part->get_name().empty(); }))
    described["commands"].push_back(describe_commands(*part));
  return described;
}

}  // namespace palpate::apps
