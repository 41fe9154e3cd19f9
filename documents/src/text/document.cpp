// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/documents/document.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <set>
#include <sstream>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/input_file.h"
#include "palpate/documents/document_node.h"

namespace palpate::documents {
namespace {

// Of lists and maps in each other: an anchor may contain itself.
constexpr int kDeepest = 32;

[[noreturn]] void refuse_line(const std::string& source, int line, const std::string& what) {
  throw FileError(source + ": line " + std::to_string(line) + ": " + what);
}

[[noreturn]] void refuse_line(const std::string& source, const YAML::Mark& mark,
                              const std::string& what) {
  refuse_line(source, mark.line + 1, what);
}

// Makes the values of a document from the nodes of yaml-cpp.
class YamlValues {
 public:
  YamlValues(std::string source, Document& document)
      : source_(std::move(source)), document_(document) {}

  Json value_of(const YAML::Node& node, const std::string& pointer, const YAML::Mark& mark,
                int depth = 0) {
    if (depth > kDeepest) {
      refuse_line(source_, node.Mark(),
                  "is nested more than " + std::to_string(kDeepest) + " levels deep");
    }
    DocumentPlace& place = document_.places[pointer];
    place.line = mark.line + 1;
    if (node.IsMap()) return object_of(node, pointer, depth);
    if (node.IsSequence()) {
      Json result = Json::array();
      for (const YAML::Node& item : node)
        result.push_back(
            value_of(item, pointer + "/" + std::to_string(result.size()), item.Mark(), depth + 1));
      return result;
    }
    if (!node.IsScalar()) return nullptr;
    place.text = node.Scalar();
    const bool quoted = node.Tag() == "!" || node.Tag() == "tag:yaml.org,2002:str";
    const Json plain = Json::parse(place.text, nullptr, false);
    return quoted || plain.is_discarded() || plain.is_structured() ? Json(place.text) : plain;
  }

 private:
  Json object_of(const YAML::Node& node, const std::string& pointer, int depth) {
    Json result = Json::object();
    for (const auto& member : node) {
      const YAML::Mark mark = member.first.Mark();
      if (!member.first.IsScalar())
        refuse_line(source_, mark, "a name has parts; expected one word");
      const std::string& name = member.first.Scalar();
      const std::string place = pointer_to(pointer, name);
      if (result.contains(name)) {
        refuse_line(source_, mark,
                    "'" + name + "' is there twice, also in line " +
                        std::to_string(document_.places[place].line) + "; keep one");
      }
      result[name] = value_of(member.second, place, mark, depth + 1);
    }
    return result;
  }

  std::string source_;
  Document& document_;
};

// Finds the line at which a document begins, and ignores everything else.
struct DocumentStart : YAML::EventHandler {
  void OnDocumentStart(const YAML::Mark& mark) override { line = mark.line + 1; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t,
                const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {}
  void OnMapEnd() override {}

  int line = 0;  // from 1
};

}  // namespace

std::optional<int> second_yaml_document(const std::string& text) {
  // YAML::LoadAll() would find documents without end in some damaged texts.
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  DocumentStart start;
  const bool second = parser.HandleNextDocument(start) && parser.HandleNextDocument(start);
  return second ? std::optional(start.line) : std::nullopt;
}

Document parse_yaml(const std::string& text, const std::string& source) {
  try {
    Document document;
    const YAML::Node root = YAML::Load(text);
    if (const auto line = second_yaml_document(text))
      refuse_line(source, *line, "a second document begins (---); expected one");
    document.value = YamlValues(source, document).value_of(root, "", root.Mark());
    return document;
  } catch (const YAML::Exception& wrong) {
    refuse_line(source, wrong.mark, "is not YAML (" + wrong.msg + ")");
  }
}

Document parse_json(const std::string& text, const std::string& source) {
  std::vector<std::set<std::string>> names;  // of the objects that are open
  Json value = Json::parse(
      text,
      [&](int /*depth*/, Json::parse_event_t event, Json& parsed) {
        if (event == Json::parse_event_t::object_start) names.emplace_back();
        if (event == Json::parse_event_t::object_end) names.pop_back();
        if (event == Json::parse_event_t::key && !names.back().insert(parsed).second)
          throw FileError(source + ": '" + parsed.get<std::string>() + "' is there twice");
        return true;
      },
      false);
  if (value.is_discarded()) throw FileError(source + ": is not JSON");
  return {std::move(value), ""};
}

bool is_yaml(const std::filesystem::path& path) {
  return path.extension() == ".yaml" || path.extension() == ".yml";
}

Document read_document(const std::filesystem::path& path) {
  const std::string text = read_input_file(path);
  return is_yaml(path) ? parse_yaml(text, path.string()) : parse_json(text, path.string());
}

std::string read_json_text(const std::filesystem::path& path) {
  std::string text = read_input_file(path);
  return is_yaml(path) ? parse_yaml(text, path.string()).value.dump(1) : text;
}

}  // namespace palpate::documents
