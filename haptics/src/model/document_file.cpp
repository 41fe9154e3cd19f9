// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "model/document_file.h"

#include <yaml-cpp/yaml.h>

#include <fstream>
#include <iterator>
#include <string>

#include "palpate/core/error.h"

namespace palpate::haptics {
namespace {

using nlohmann::json;

json value_of(const YAML::Node& node, const std::string& file) {
  if (node.IsMap()) {
    json result = json::object();
    for (const auto& member : node) {
      const auto name = member.first.as<std::string>();
      if (result.contains(name)) {
        throw FileError(file + ":" + std::to_string(member.first.Mark().line + 1) + ": '" + name +
                        "' is there twice");
      }
      result[name] = value_of(member.second, file);
    }
    return result;
  }
  if (node.IsSequence()) {
    json result = json::array();
    for (const YAML::Node& item : node) result.push_back(value_of(item, file));
    return result;
  }
  if (!node.IsScalar()) return nullptr;
  const bool quoted = node.Tag() == "!";
  const json plain = json::parse(node.Scalar(), nullptr, false);
  return quoted || plain.is_discarded() || plain.is_structured() ? json(node.Scalar()) : plain;
}

}  // namespace

json read_document_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  if (!in.good() && !in.eof()) {
    throw FileError(path.string() + ": cannot be read; expected a file in YAML or JSON");
  }
  if (path.extension() != ".yaml" && path.extension() != ".yml") {
    json document = json::parse(text, nullptr, false);
    if (document.is_discarded()) throw FileError(path.string() + ": is not JSON");
    return document;
  }
  try {
    return value_of(YAML::Load(text), path.string());
  } catch (const YAML::Exception& wrong) {
    throw FileError(path.string() + ":" + std::to_string(wrong.mark.line + 1) +
                    ": is not YAML: " + wrong.msg);
  }
}

}  // namespace palpate::haptics
