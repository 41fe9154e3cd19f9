// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "model/document_file.h"

#include <yaml-cpp/yaml.h>

#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include "palpate/core/error.h"

namespace palpate::haptics {
namespace {

using nlohmann::json;

// Of lists and maps in each other: an anchor may contain itself.
constexpr int kDeepest = 32;

json value_of(const YAML::Node& node, const std::string& file, int depth = 0) {
  if (depth > kDeepest) {
    throw FileError(file + ":" + std::to_string(node.Mark().line + 1) + ": is nested more than " +
                    std::to_string(kDeepest) + " levels deep");
  }
  if (node.IsMap()) {
    json result = json::object();
    for (const auto& member : node) {
      const auto name = member.first.as<std::string>();
      if (result.contains(name)) {
        throw FileError(file + ":" + std::to_string(member.first.Mark().line + 1) + ": '" + name +
                        "' is there twice");
      }
      result[name] = value_of(member.second, file, depth + 1);
    }
    return result;
  }
  if (node.IsSequence()) {
    json result = json::array();
    for (const YAML::Node& item : node) result.push_back(value_of(item, file, depth + 1));
    return result;
  }
  if (!node.IsScalar()) return nullptr;
  const bool quoted = node.Tag() == "!" || node.Tag() == "tag:yaml.org,2002:str";
  const json plain = json::parse(node.Scalar(), nullptr, false);
  return quoted || plain.is_discarded() || plain.is_structured() ? json(node.Scalar()) : plain;
}

json json_of(const std::string& text, const std::string& file) {
  std::vector<std::set<std::string>> names;  // of the objects that are open
  json document = json::parse(
      text,
      [&](int /*depth*/, json::parse_event_t event, json& parsed) {
        if (event == json::parse_event_t::object_start) names.emplace_back();
        if (event == json::parse_event_t::object_end) names.pop_back();
        if (event == json::parse_event_t::key && !names.back().insert(parsed).second)
          throw FileError(file + ": '" + parsed.get<std::string>() + "' is there twice");
        return true;
      },
      false);
  if (document.is_discarded()) throw FileError(file + ": is not JSON");
  return document;
}

}  // namespace

json read_document_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  if (!in.good() && !in.eof()) {
    throw FileError(path.string() + ": cannot be read; expected a file in YAML or JSON");
  }
  if (path.extension() != ".yaml" && path.extension() != ".yml") {
    return json_of(text, path.string());
  }
  try {
    return value_of(YAML::Load(text), path.string());
  } catch (const YAML::Exception& wrong) {
    throw FileError(path.string() + ":" + std::to_string(wrong.mark.line + 1) +
                    ": is not YAML: " + wrong.msg);
  }
}

}  // namespace palpate::haptics
