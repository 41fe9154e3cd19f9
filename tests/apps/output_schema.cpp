// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "output_schema.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

#include "repository.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

using nlohmann::json;
using valijson::adapters::NlohmannJsonAdapter;

/// The schema of a command in docs/output.schema.json, read once; null if it has none.
const valijson::Schema* schema_of(const std::string& command) {
  struct Described {
    json text;
    valijson::Schema schema;
  };
  static const json document = json::parse(read_text(repository("docs/output.schema.json")));
  static std::map<std::string, Described> read;
  const json& commands = document["definitions"]["commands"];
  if (!commands.contains(command)) return nullptr;
  const auto [place, is_new] = read.try_emplace(command);
  Described& described = place->second;
  if (is_new) {
    described.text = commands[command];
    described.text["definitions"] = document["definitions"];
    valijson::SchemaParser(valijson::SchemaParser::kDraft7)
        .populateSchema(NlohmannJsonAdapter(described.text), described.schema);
  }
  return &described.schema;
}

}  // namespace

std::optional<std::string> command_with_figures(const std::vector<std::string>& call) {
  const auto command =
      std::ranges::find_if(call, [](const std::string& word) { return !word.starts_with('-'); });
  const auto option = std::ranges::find(call, "--json");
  if (command == call.end() || option == call.end()) return std::nullopt;
  if (*command == "export" && option > command) return std::nullopt;
  if (*command == "calibrate") return *command + " " + *(command + 1);
  return *command;
}

std::string differences_from_schema(const std::string& command, const std::string& output) {
  const json figures = json::parse(output, nullptr, false);
  if (figures.is_discarded()) return command + ": not JSON: " + output;
  const valijson::Schema* const schema = schema_of(command);
  if (schema == nullptr) return command + ": has no schema";
  valijson::ValidationResults results;
  valijson::Validator().validate(*schema, NlohmannJsonAdapter(figures), &results);
  std::string differences;
  for (valijson::ValidationResults::Error error; results.popError(error);) {
    differences += command + ": ";
    for (const std::string& part : error.context) differences += part;
    differences += ": " + error.description + "\n";
  }
  return differences;
}

}  // namespace palpate::apps
