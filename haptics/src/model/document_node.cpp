// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "model/document_node.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "palpate/core/error.h"

namespace palpate::haptics {
namespace {

using nlohmann::json;

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

// Finds the JSON pointer of a value by search. Nodes do not store it because few ever need it.
bool append_pointer(const json& value, const json& root, std::string& pointer) {
  if (&value == &root) return true;
  const std::size_t length = pointer.size();
  const auto lies_in = [&](const std::string& name, const json& child) {
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

void refuse(const std::string& pointer, const std::string& found, const std::string& right) {
  throw InvalidInput("at " + (pointer.empty() ? "the top" : pointer) + ": found " + found +
                     ", expected " + right);
}

DocumentNode DocumentNode::at(const char* key) const {
  if (!value_->is_object()) refuse("an object");
  const auto found = value_->find(key);
  if (found == value_->end()) refuse(std::string("an object with the member \"") + key + "\"");
  return {part_, *found};
}

std::optional<DocumentNode> DocumentNode::find(const char* key) const {
  if (!value_->is_object()) refuse("an object");
  const auto found = value_->find(key);
  if (found == value_->end()) return std::nullopt;
  return DocumentNode(part_, *found);
}

std::vector<DocumentNode> DocumentNode::items() const {
  if (!value_->is_array()) refuse("an array");
  std::vector<DocumentNode> result;
  result.reserve(value_->size());
  for (const json& item : *value_) result.push_back({part_, item});
  return result;
}

void DocumentNode::expect_only(std::span<const std::string> known) const {
  if (!value_->is_object()) refuse("an object");
  for (const auto& [name, value] : value_->items()) {
    if (std::ranges::find(known, name) != known.end()) continue;
    std::string list;
    for (const std::string& each : known) list.append(list.empty() ? "" : ", ").append(each);
    std::string pointer = part_->pointer;
    append_pointer(*value_, part_->value, pointer);
    haptics::refuse(pointer, "the member '" + name + "'", "only " + list);
  }
}

double DocumentNode::number() const {
  if (!value_->is_number()) refuse("a number");
  const double result = value_->get<double>();
  // The negated comparison also refuses NaN, which CBOR can represent.
  if (!(std::abs(result) <= kLargestNumber)) refuse("a finite number of at most 1e12");
  return result;
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
    numbers[i] = DocumentNode(part_, (*value_)[i]).number();
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
    result.row(i) = DocumentNode(part_, (*value_)[static_cast<std::size_t>(i)]).vector();
  return result;
}

std::map<std::string, std::string> DocumentNode::texts() const {
  if (!value_->is_object()) refuse("an object of strings");
  std::map<std::string, std::string> result;
  for (const auto& [key, value] : value_->items()) result[key] = DocumentNode(part_, value).text();
  return result;
}

void DocumentNode::refuse(const std::string& right) const {
  constexpr std::size_t kShownLength = 40;
  std::string found = value_->is_array() ? "an array of " + std::to_string(value_->size())
                      : value_->is_object()
                          ? "an object of " + std::to_string(value_->size())
                          : value_->dump(-1, ' ', true, json::error_handler_t::replace);
  if (found.size() > kShownLength) found = found.substr(0, kShownLength) + "...";
  std::string pointer = part_->pointer;
  append_pointer(*value_, part_->value, pointer);
  haptics::refuse(pointer, found, right);
}

}  // namespace palpate::haptics
