// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/documents/document_node.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace palpate::documents {
namespace {

// A key in a JSON pointer (RFC 6901).
std::string escaped(const std::string& key) {
  std::string result;
  for (const char c : key) {
    if (c == '~')
      result += "~0";
    else if (c == '/')
      result += "~1";
    else
      result += c;
  }
  return result;
}

// The words of a message about what may be there: "a, b, c".
std::string list_of(std::span<const std::string> names) {
  std::string list;
  for (const std::string& each : names) list.append(list.empty() ? "" : ", ").append(each);
  return list;
}

// "DecodeOptions::min_signal" is written 'min_signal' in a document.
std::string name_in_document(const std::string& field) {
  const std::size_t colon = field.rfind(':');
  std::string name = "'";
  return name.append(field.substr(colon == std::string::npos ? 0 : colon + 1)).append("'");
}

// A value as a message quotes it.
std::string shown(const Json& value) {
  constexpr std::size_t kMostItems = 6, kShownLength = 40;
  const bool is_short = !value.is_structured() || value.size() <= kMostItems;
  std::string text =
      is_short ? value.dump(-1, ' ', true, Json::error_handler_t::replace) : std::string();
  if (is_short && text.size() <= kShownLength) return text;
  if (value.is_array()) return "an array of " + std::to_string(value.size());
  if (value.is_object()) return "an object of " + std::to_string(value.size());
  return text.substr(0, kShownLength) + "...";
}

// Finds the JSON pointer of a value by search. Nodes do not store it because few ever need it.
bool append_pointer(const Json& value, const Json& root, std::string& pointer) {
  if (&value == &root) return true;
  const std::size_t length = pointer.size();
  const auto lies_in = [&](const std::string& name, const Json& child) {
    pointer += '/';
    pointer += name;
    if (append_pointer(value, child, pointer)) return true;
    pointer.resize(length);
    return false;
  };
  if (root.is_object()) {
    for (const auto& [key, member] : root.items()) {
      if (lies_in(escaped(key), member)) return true;
    }
  } else if (root.is_array()) {
    for (std::size_t i = 0; i < root.size(); ++i) {
      if (lies_in(std::to_string(i), root[i])) return true;
    }
  }
  return false;
}

}  // namespace

std::string pointer_to(const std::string& pointer, const std::string& member) {
  return pointer + "/" + escaped(member);
}

void refuse(const std::string& pointer, const std::string& found, const std::string& right) {
  throw InvalidInput("at " + (pointer.empty() ? "the top" : pointer) + ": found " + found +
                     ", expected " + right);
}

DocumentNode DocumentNode::at(const char* key) const {
  if (!value_->is_object()) refuse("an object");
  const auto found = value_->find(key);
  if (found == value_->end()) refuse(std::string("an object with the member \"") + key + "\"");
  return {document_, *found};
}

std::optional<DocumentNode> DocumentNode::find(const char* key) const {
  if (!value_->is_object()) refuse("an object");
  const auto found = value_->find(key);
  if (found == value_->end()) return std::nullopt;
  return DocumentNode(document_, *found);
}

std::vector<DocumentNode> DocumentNode::items() const {
  if (!value_->is_array()) refuse("an array");
  std::vector<DocumentNode> result;
  result.reserve(value_->size());
  for (const Json& item : *value_) result.push_back({document_, item});
  return result;
}

void DocumentNode::expect_only(std::span<const std::string> known) const {
  if (!value_->is_object()) refuse("an object");
  for (const auto& [name, value] : value_->items()) {
    if (std::ranges::find(known, name) != known.end()) continue;
    at(name.c_str()).fail("'" + name + "' is unknown; there are " + list_of(known));
  }
}

double DocumentNode::number() const {
  if (!value_->is_number()) refuse("a number");
  const double result = value_->get<double>();
  // The negated comparison also refuses NaN, which CBOR can represent.
  if (!(std::abs(result) <= kLargestDocumentNumber)) refuse("a finite number of at most 1e12");
  return result;
}

double DocumentNode::number(const Interval& range, std::string_view unit) const {
  const bool fits = value_->is_number() && range.contains(value_->get<double>());
  if (fits) return value_->get<double>();
  const std::string words = to_string(range);
  refuse((words == "finite" ? "a finite number" : "a number " + words) +
         (unit.empty() ? "" : " [" + std::string(unit) + "]"));
}

double DocumentNode::number_at_least_zero() const {
  const double result = number();
  if (result < 0) refuse("a number >= 0");
  return result;
}

double DocumentNode::number_above_zero() const {
  const double result = number();
  if (!(result > 0)) refuse("a number > 0");
  return result;
}

long long DocumentNode::integer() const {
  if (!value_->is_number_integer()) refuse("a whole number");
  constexpr auto kLargest = static_cast<unsigned long long>(std::numeric_limits<long long>::max());
  if (value_->is_number_unsigned() && value_->get<unsigned long long>() > kLargest)
    refuse("a whole number of at most 2^63 - 1");
  return value_->get<long long>();
}

int DocumentNode::integer(const Interval& range) const {
  const long long result = value_->is_number_integer() ? integer() : 0;
  if (!value_->is_number_integer() || !std::in_range<int>(result) ||
      !range.contains(static_cast<double>(result)))
    refuse("a whole number " + to_string(range));
  return static_cast<int>(result);
}

int DocumentNode::integer_between(int lowest, int highest) const {
  const bool is_whole = value_->is_number_integer();
  const long long result = is_whole ? integer() : 0;
  if (!is_whole || result < lowest || result > highest) {
    refuse("a whole number from " + std::to_string(lowest) + " to " + std::to_string(highest));
  }
  return static_cast<int>(result);
}

bool DocumentNode::truth() const {
  if (!value_->is_boolean()) refuse("true or false");
  return value_->get<bool>();
}

const std::string& DocumentNode::text(const std::string& right) const {
  if (!value_->is_string()) refuse(right);
  return value_->get_ref<const std::string&>();
}

void DocumentNode::expect_text(const std::string& right) const {
  if (text() != right) refuse("\"" + right + "\"");
}

std::string DocumentNode::word() const {
  if (value_->is_structured()) refuse("one word or number");
  if (const auto place = document_->places.find(pointer()); place != document_->places.end())
    return place->second.text;
  if (value_->is_null()) return {};
  return value_->is_string() ? value_->get<std::string>() : value_->dump();
}

std::size_t DocumentNode::choice(std::span<const char* const> words) const {
  const std::string& word = text();
  std::string right;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (word == words[i]) return i;
    right += i == 0 ? "" : i + 1 == words.size() ? " or " : ", ";
    right.append("\"").append(words[i]).append("\"");
  }
  refuse(right);
}

void DocumentNode::read(std::span<double> numbers, const char* right) const {
  if (!value_->is_array() || value_->size() != numbers.size()) refuse(right);
  for (std::size_t i = 0; i < numbers.size(); ++i)
    numbers[i] = DocumentNode(document_, (*value_)[i]).number();
}

Eigen::Vector3d DocumentNode::vector() const {
  Eigen::Vector3d result;
  read({result.data(), 3}, "an array of three numbers");
  return result;
}

Eigen::Matrix3d DocumentNode::rows() const {
  if (!value_->is_array() || value_->size() != 3)
    refuse("an array of three arrays of three numbers");
  Eigen::Matrix3d result;
  for (int i = 0; i < 3; ++i)
    result.row(i) = DocumentNode(document_, (*value_)[static_cast<std::size_t>(i)]).vector();
  return result;
}

std::map<std::string, std::string> DocumentNode::texts() const {
  if (!value_->is_object()) refuse("an object of strings");
  std::map<std::string, std::string> result;
  for (const auto& [key, value] : value_->items())
    result[key] = DocumentNode(document_, value).text();
  return result;
}

void DocumentNode::for_each_member(
    const std::function<void(const std::string& name, const DocumentNode& member)>& read) const {
  if (!value_->is_object()) refuse("an object");
  for (const auto& [name, value] : value_->items()) read(name, DocumentNode(document_, value));
}

std::string DocumentNode::pointer() const {
  std::string pointer = document_->pointer;
  append_pointer(*value_, document_->value, pointer);
  return pointer;
}

int DocumentNode::line() const {
  const auto place = document_->places.find(pointer());
  return place == document_->places.end() ? 0 : place->second.line;
}

void DocumentNode::refuse(const std::string& right) const {
  fail("found " + shown(*value_) + ", expected " + right);
}

void DocumentNode::fail(const std::string& what) const {
  const std::string place = pointer();
  const int in_line = line();
  throw InvalidInput((in_line > 0 ? "line " + std::to_string(in_line) + ", " : "") + "at " +
                     (place.empty() ? "the top" : place) + ": " + what);
}

void DocumentNode::fail(const InvalidInput& wrong) const {
  fail(wrong.with_names(name_in_document));
}

DocumentMembers::DocumentMembers(const DocumentNode& object) : object_(object) {
  if (!object.value().is_object()) object.refuse("an object");
}

std::optional<DocumentNode> DocumentMembers::find(const char* name) {
  if (std::ranges::find(known_, name) == known_.end()) known_.emplace_back(name);
  return object_.find(name);
}

DocumentNode DocumentMembers::at(const char* name) {
  if (const auto found = find(name)) return *found;
  object_.fail("has no '" + std::string(name) + "'");
}

void DocumentMembers::take(const char* name, double& value, const Interval& range,
                           std::string_view unit) {
  if (const auto found = find(name)) value = found->number(range, unit);
}

void DocumentMembers::take(const char* name, int& value, const Interval& range) {
  if (const auto found = find(name)) value = found->integer(range);
}

void DocumentMembers::take(const char* name, bool& value) {
  if (const auto found = find(name)) value = found->truth();
}

void DocumentMembers::take(const char* name, Eigen::Vector3d& value) {
  if (const auto found = find(name)) value = found->vector();
}

void DocumentMembers::end() const { object_.expect_only(known_); }

}  // namespace palpate::documents
