// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace palpate::documents {

/// Members keep the order that they have in the text.
using Json = nlohmann::ordered_json;

/// Line of a value or of a member (a name with its value), and its spelling in the file: "0.50".
struct DocumentPlace {
  int line = 0;  ///< from 1; of a member, the line of its name
  std::string text;
};

/// A document in JSON or YAML, or a part of one.
struct Document {
  Json value;
  std::string pointer;  ///< JSON pointer (RFC 6901) to `value` in the whole document
  /// Places of the values by JSON pointer. Empty for JSON, whose parser does not report lines.
  std::map<std::string, DocumentPlace, std::less<>> places = {};
};

/// Parses a text in YAML. Words without quotes that are numbers, true, false or null in JSON get
/// these values; all other words are texts.
/// \param source names the text in messages.
/// \throws FileError with the line if the text is not one document in YAML, has a member twice, or
/// is nested more than 32 levels deep.
[[nodiscard]] Document parse_yaml(const std::string& text, const std::string& source);

/// The line, from 1, at which a second document begins in a text in YAML.
/// \throws YAML::Exception of yaml-cpp if the text is not YAML.
[[nodiscard]] std::optional<int> second_yaml_document(const std::string& text);

/// Parses a text in JSON.
/// \throws FileError naming `source` if the text is not JSON or has a member twice.
[[nodiscard]] Document parse_json(const std::string& text, const std::string& source);

/// Returns true if a name ends in .yaml or .yml.
[[nodiscard]] bool is_yaml(const std::filesystem::path& path);

/// Reads a file that people write: YAML if `is_yaml`, JSON otherwise.
/// \throws FileError also if the file is missing, empty or unreadable.
[[nodiscard]] Document read_document(const std::filesystem::path& path);

/// The text of such a file in JSON; that of a JSON file as it is.
/// \throws FileError as `read_document`.
[[nodiscard]] std::string read_json_text(const std::filesystem::path& path);

}  // namespace palpate::documents
