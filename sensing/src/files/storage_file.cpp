// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "files/storage_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <limits>
#include <mutex>
#include <opencv2/core/utils/logger.hpp>
#include <optional>
#include <set>
#include <string_view>
#include <type_traits>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/core/input_file.h"
#include "palpate/documents/document.h"

namespace palpate::sensing {
namespace {

/// OpenCV writes maps within a line as `{ name:R }`. YAML wants a space after the colon, which this
/// inserts.
std::string with_spaces_after_keys(std::string_view text) {
  std::string result;
  int braces = 0;
  bool quoted = false;
  bool in_key = false;  // may be: only letters since a brace or comma
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    result += c;
    if (c == '"' && (i == 0 || text[i - 1] != '\\')) quoted = !quoted;
    if (quoted) continue;
    if (c == '{') ++braces;
    if (c == '}') --braces;
    if (c == ':' && in_key && braces > 0) result += ' ';
    const auto letter = static_cast<unsigned char>(c);
    in_key = c == '{' || c == ',' ||
             (in_key && (std::isalnum(letter) || std::isspace(letter) || c == '_'));
  }
  return result;
}

/// yaml-cpp quotes characters of the file, which may be anything.
std::string printable(std::string text) {
  std::replace_if(
      text.begin(), text.end(),
      [](char c) { return std::isprint(static_cast<unsigned char>(c)) == 0; }, '?');
  return text;
}

/// Refuses a key that occurs twice: only the first would be read.
void refuse_repeated_keys(const std::filesystem::path& path, const YAML::Node& map) {
  std::set<std::string> keys;
  for (const auto& entry : map) {
    const YAML::Node& key = entry.first;
    if (!key.IsScalar() || keys.insert(key.Scalar()).second) continue;
    throw FileError(path.string() + ": line " + std::to_string(key.Mark().line + 1) + ": " +
                    printable(key.Scalar()) + " is there twice; keep one");
  }
}

/// "line 3: " of the place where parsing ended, if it is known.
std::string line_of(const YAML::Exception& error) {
  return error.mark.is_null() ? "" : "line " + std::to_string(error.mark.line + 1) + ": ";
}

/// The first document of a text, a map.
/// \param kind     a text for the message if this fails: the kind that the file is not.
/// \param expected the text for the message about what is expected.
YAML::Node first_document(const std::filesystem::path& path, const std::string& text,
                          const std::string& kind, const std::string& expected) {
  YAML::Node root;
  try {
    root = YAML::Load(text);
  } catch (const YAML::Exception& error) {
    throw FileError(path.string() + ": " + line_of(error) + "not " + kind + " (" +
                    printable(error.msg) + "); " + expected);
  }
  if (!root.IsMap()) throw FileError(path.string() + ": not " + kind + "; " + expected);
  refuse_repeated_keys(path, root);
  return root;
}

YAML::Node parse(const std::filesystem::path& path, const std::string& bytes) {
  const std::string kind = "an OpenCV FileStorage file";
  const std::string expected =
      "a YAML file that begins with %YAML:1.0 and holds keys and values is expected";
  const std::string text = with_spaces_after_keys(bytes);
  YAML::Node root = first_document(path, text, kind, expected);
  std::optional<int> second;
  try {
    second = documents::second_yaml_document(text);
  } catch (const YAML::Exception& error) {
    throw FileError(path.string() + ": " + line_of(error) + "not " + kind + " (" +
                    printable(error.msg) + "); " + expected);
  }
  if (second)
    throw FileError(path.string() + ": line " + std::to_string(*second) +
                    ": the keys and values end before this line, but more follows; a second "
                    "document (--- or ...)?");
  return root;
}

/// False if the node is not the text of such a number. Texts in quotes are none.
template <typename Number>
bool decode(const YAML::Node& node, Number& value) {
  if (!node.IsScalar() || node.Tag() == "!") return false;
  if constexpr (std::is_floating_point_v<Number>) {
    value = std::numeric_limits<Number>::quiet_NaN();
    if (node.Scalar() == ".Nan") return true;  // as OpenCV writes it, not as YAML does
  }
  return YAML::convert<Number>::decode(node, value);
}

/// The log level of OpenCV while any QuietOpenCv exists.
struct Silence {
  std::mutex mutex;
  int wanted_by = 0;
  cv::utils::logging::LogLevel before = cv::utils::logging::LOG_LEVEL_SILENT;
};

Silence& silence() {
  static Silence the_silence;
  return the_silence;
}

}  // namespace

QuietOpenCv::QuietOpenCv() {
  Silence& shared = silence();
  const std::lock_guard lock(shared.mutex);
  if (shared.wanted_by++ > 0) return;
  shared.before = cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
}

QuietOpenCv::~QuietOpenCv() {
  Silence& shared = silence();
  const std::lock_guard lock(shared.mutex);
  if (--shared.wanted_by == 0) cv::utils::logging::setLogLevel(shared.before);
}

StorageFile::StorageFile(std::filesystem::path path)
    : path_(std::move(path)), root_(parse(path_, read_input_file(path_))) {}

StorageFile::StorageFile(std::filesystem::path path, const std::string& bytes)
    : path_(std::move(path)), root_(parse(path_, bytes)) {}

StorageFile::StorageFile(std::filesystem::path path, std::string bytes, const std::string& expected)
    : path_(std::move(path)) {
  // Open3D indents its JSON with tabs, which YAML does not have.
  std::ranges::replace(bytes, '\t', ' ');
  root_ = first_document(path_, with_spaces_after_keys(bytes),
                         "a YAML or JSON file of keys and values", expected);
}

void StorageFile::fail(const std::string& key, const std::string& message) const {
  throw FileError(path_.string() + ": " + key + ": " + message);
}

YAML::Node StorageFile::find(const YAML::Node& parent, const std::string& key) {
  return parent.IsMap() ? parent[key] : YAML::Node(YAML::NodeType::Undefined);
}

YAML::Node StorageFile::child(const YAML::Node& parent, const std::string& key,
                              const std::string& place) const {
  YAML::Node node = find(parent, key);
  if (!node.IsDefined()) fail(place + key, "is missing");
  return node;
}

void StorageFile::allow_only(const YAML::Node& map, const std::set<std::string>& keys,
                             const std::string& place) const {
  for (const auto& entry : map) {
    const std::string& key = entry.first.Scalar();
    if (!keys.contains(key))
      fail(place + key, fmt::format("is not known; known are {}", fmt::join(keys, ", ")));
  }
}

double StorageFile::number(const YAML::Node& node, const std::string& key) const {
  double value = 0;
  if (!decode(node, value)) fail(key, "a number is expected");
  if (!std::isfinite(value)) fail(key, "is not finite");
  return value;
}

int StorageFile::whole_number(const YAML::Node& node, const std::string& key) const {
  int value = 0;
  if (!decode(node, value)) fail(key, "a whole number is expected");
  return value;
}

std::string StorageFile::scalar(const YAML::Node& node, const std::string& key) const {
  if (!node.IsScalar()) fail(key, "one value is expected");
  return node.Scalar();
}

std::string StorageFile::text(const YAML::Node& node, const std::string& key) const {
  double number = 0;
  if (!node.IsScalar() || decode(node, number)) fail(key, "a text is expected");
  return node.Scalar();
}

std::vector<YAML::Node> StorageFile::items(const YAML::Node& node, const std::string& key) const {
  if (!node.IsSequence()) fail(key, "a list is expected");
  return {node.begin(), node.end()};
}

std::vector<double> StorageFile::numbers(const YAML::Node& node, const std::string& key) const {
  std::vector<double> values;
  for (const YAML::Node& item : items(node, key)) {
    values.push_back(number(item, key + "[" + std::to_string(values.size()) + "]"));
  }
  return values;
}

cv::Mat_<double> StorageFile::matrix(const std::string& key) const {
  const YAML::Node node = child(root(), key);
  const auto count = [&](const char* entry) {
    int value = 0;
    const YAML::Node found = find(node, entry);
    return found.IsDefined() && decode(found, value) ? std::max(value, 0) : 0;
  };
  const int rows = count("rows");
  const int columns = count("cols");
  const YAML::Node data = find(node, "data");
  const YAML::Node type = find(node, "dt");
  const double size = static_cast<double>(rows) * columns;
  if (size == 0 || !type.IsDefined() || !type.IsScalar() || !data.IsDefined() ||
      !data.IsSequence() || static_cast<double>(data.size()) != size) {
    fail(key, "a matrix is expected: rows, cols, dt, and data with rows x cols numbers");
  }
  if (type.Scalar().size() != 1) fail(key, "a matrix of one channel is expected");
  const std::vector<double> values = numbers(data, key + ".data");
  return cv::Mat_<double>(values, true).reshape(1, rows);
}

}  // namespace palpate::sensing
