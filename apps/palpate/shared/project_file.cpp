// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/project_file.h"

#include "palpate/core/error.h"
#include "palpate/core/input_file.h"
#include "palpate/documents/document.h"
#include "palpate/documents/document_node.h"

namespace palpate::apps {
namespace {

using documents::DocumentNode;

/// Refuses a value of a project at its line.
class ProjectPage {
 public:
  explicit ProjectPage(fs::path path) : path_(std::move(path)) {}

  [[noreturn]] void refuse(const DocumentNode& at, const std::string& what) const {
    refuse_in_project(path_, at.line(), what);
  }

  /// A word or number that is not empty.
  [[nodiscard]] std::string word(const DocumentNode& node, const std::string& name) const {
    const std::string word = node.value().is_structured() ? "" : node.word();
    if (word.empty())
      refuse(node, name + ": has no value, or one with parts; expected a word or a number");
    if (word.find('\0') != std::string::npos)
      refuse(node, name + ": has a character with the code 0");
    return word;
  }

  [[nodiscard]] std::vector<std::string> words(const DocumentNode& list,
                                               const std::string& name) const {
    std::vector<std::string> result;
    if (list.value().is_array())
      for (const DocumentNode& item : list.items()) result.push_back(word(item, name));
    if (result.empty()) refuse(list, name + ": is an empty list");
    return result;
  }

  [[nodiscard]] ProjectEntry entry(const std::string& name, const DocumentNode& value) const {
    ProjectEntry entry{.name = name, .line = value.line(), .values = {}};
    const documents::Json& json = value.value();
    if (json.is_object())
      refuse(value, name + ": has entries of its own; expected a value or a list of values");
    if (!json.is_array())
      entry.values.push_back({word(value, name)});
    else if (!json.empty() && json[0].is_array())
      for (const DocumentNode& list : value.items()) entry.values.push_back(words(list, name));
    else
      entry.values.push_back(words(value, name));
    return entry;
  }

  [[nodiscard]] ProjectSection section(const std::string& name, const DocumentNode& node) const {
    ProjectSection section{.name = name, .line = node.line(), .entries = {}};
    if (node.value().is_null()) return section;
    if (!node.value().is_object())
      refuse(node, name + ": expected entries such as {tolerance: 0.2}, or nothing");
    node.for_each_member([&](const std::string& key, const DocumentNode& value) {
      section.entries.push_back(entry(key, value));
    });
    return section;
  }

  [[nodiscard]] Project project(const DocumentNode& root) const {
    Project project;
    if (!root.value().is_object())
      refuse(root, "expected sections with entries, such as fit: {accuracy: 0.02}");
    root.for_each_member([&](const std::string& key, const DocumentNode& value) {
      if (key == "output")
        project.output = word(value, key);
      else
        project.sections.push_back(section(key, value));
    });
    return project;
  }

 private:
  fs::path path_;
};

}  // namespace

Project read_project(const fs::path& path) {
  const documents::Document document = documents::parse_yaml(read_input_file(path), path.string());
  if (document.value.is_null()) {
    throw FileError(path.string() +
                    ": is empty; expected sections such as fit: {surface: surface.ply}.");
  }
  return ProjectPage(path).project(DocumentNode(document));
}

void refuse_in_project(const fs::path& path, int line, const std::string& what) {
  const bool is_sentence = what.ends_with('?') || what.ends_with('.');
  throw FileError(path.string() + ": line " + std::to_string(line) + ": " + what +
                  (is_sentence ? "" : "."));
}

}  // namespace palpate::apps
