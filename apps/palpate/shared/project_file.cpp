// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/project_file.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <system_error>

#include "palpate/core/error.h"

namespace palpate::apps {
namespace {

/// A project file while it is read.
class ProjectPage {
 public:
  explicit ProjectPage(fs::path path) : path_(std::move(path)) {}

  [[noreturn]] void refuse(const YAML::Node& at, const std::string& what) const {
    refuse_in_project(path_, line_of(at), what);
  }

  static int line_of(const YAML::Node& node) { return node.Mark().line + 1; }

  /// A word or number that is not empty.
  [[nodiscard]] std::string word(const YAML::Node& node, const std::string& name) const {
    if (!node.IsScalar() || node.Scalar().empty())
      refuse(node, name + ": has no value, or one with parts; expected a word or a number");
    if (node.Scalar().find('\0') != std::string::npos)
      refuse(node, name + ": has a character with the code 0");
    return node.Scalar();
  }

  [[nodiscard]] std::vector<std::string> words(const YAML::Node& list,
                                               const std::string& name) const {
    std::vector<std::string> result;
    for (const YAML::Node& item : list) result.push_back(word(item, name));
    if (result.empty()) refuse(list, name + ": is an empty list");
    return result;
  }

  [[nodiscard]] ProjectEntry entry(const std::string& name, int line,
                                   const YAML::Node& value) const {
    ProjectEntry entry{.name = name, .line = line, .values = {}};
    if (value.IsMap())
      refuse(value, name + ": has entries of its own; expected a value or a list of values");
    if (!value.IsSequence())
      entry.values.push_back({word(value, name)});
    else if (value.size() > 0 && value[0].IsSequence())
      for (const YAML::Node& list : value) entry.values.push_back(words(list, name));
    else
      entry.values.push_back(words(value, name));
    return entry;
  }

  [[nodiscard]] ProjectSection section(const std::string& name, int line,
                                       const YAML::Node& node) const {
    ProjectSection section{.name = name, .line = line, .entries = {}};
    if (node.IsNull()) return section;
    if (!node.IsMap())
      refuse(node, name + ": expected entries such as {tolerance: 0.2}, or nothing");
    for (const auto& item : node) {
      const std::string key = word(item.first, name);
      refuse_second(item.first, section.entries, key);
      section.entries.push_back(entry(key, line_of(item.first), item.second));
    }
    return section;
  }

  [[nodiscard]] Project project(const YAML::Node& root) const {
    Project project;
    if (!root.IsMap())
      refuse(root, "expected sections with entries, such as fit: {accuracy: 0.02}");
    for (const auto& item : root) {
      const std::string key = word(item.first, "the name of a section");
      if (key == "output") {
        if (!project.output.empty()) refuse(item.first, "output: is there twice; keep one");
        project.output = word(item.second, key);
        continue;
      }
      refuse_second(item.first, project.sections, key);
      project.sections.push_back(section(key, line_of(item.first), item.second));
    }
    return project;
  }

 private:
  template <typename Named>
  void refuse_second(const YAML::Node& at, const std::vector<Named>& earlier,
                     const std::string& name) const {
    const auto first = std::ranges::find(earlier, name, &Named::name);
    if (first == earlier.end()) return;
    refuse(at,
           name + ": is there twice, also in line " + std::to_string(first->line) + "; keep one");
  }

  fs::path path_;
};

std::string text_of_project(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) {
    throw FileError(path.string() +
                    (fs::is_directory(path, error) ? ": is a folder" : ": there is no such file") +
                    "; expected a project file (YAML).");
  }
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!file.good() && !file.eof()) throw FileError(path.string() + ": cannot be read.");
  return text;
}

}  // namespace

Project read_project(const fs::path& path) {
  const std::string text = text_of_project(path);
  try {
    const std::vector<YAML::Node> documents = YAML::LoadAll(text);
    if (documents.empty() || documents.front().IsNull()) {
      throw FileError(path.string() +
                      ": is empty; expected sections such as fit: {surface: surface.ply}.");
    }
    const ProjectPage page(path);
    if (documents.size() > 1)
      page.refuse(documents[1], "a second document begins (---); expected one");
    return page.project(documents.front());
  } catch (const YAML::Exception& error) {
    refuse_in_project(path, error.mark.line + 1, "is not YAML (" + error.msg + ")");
  }
}

void refuse_in_project(const fs::path& path, int line, const std::string& what) {
  const bool is_sentence = what.ends_with('?') || what.ends_with('.');
  throw FileError(path.string() + ": line " + std::to_string(line) + ": " + what +
                  (is_sentence ? "" : "."));
}

}  // namespace palpate::apps
