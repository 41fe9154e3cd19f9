// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace palpate::haptics {

/// Largest magnitude of a number in a document, in any unit. A larger one would be a mistake, and
/// the square of a smaller one is finite.
inline constexpr double kLargestNumber = 1e12;

/// A part of a JSON document: its value, and the JSON pointer to it in the document.
struct DocumentPart {
  nlohmann::json value;
  std::string pointer;
};

/// \throws InvalidInput "at POINTER: found FOUND, expected RIGHT".
[[noreturn]] void refuse(const std::string& pointer, const std::string& found,
                         const std::string& right);

/// Typed access to a value inside a part of a JSON document. Every function throws InvalidInput if
/// the value is not of the requested kind: the message has the JSON pointer, the value found, and
/// what would be right. The part must outlive the node.
class DocumentNode {
 public:
  explicit DocumentNode(const DocumentPart& part) : part_(&part), value_(&part.value) {}

  [[nodiscard]] DocumentNode at(const char* key) const;
  /// Nullopt if there is no such member.
  [[nodiscard]] std::optional<DocumentNode> find(const char* key) const;
  [[nodiscard]] std::vector<DocumentNode> items() const;
  /// Refuses an object with another member than these.
  void expect_only(std::span<const std::string> known) const;

  /// Finite and at most `kLargestNumber` in size.
  [[nodiscard]] double number() const;
  [[nodiscard]] double number_at_least_zero() const;
  [[nodiscard]] double number_above_zero() const;
  /// Fills `numbers` from a list of exactly as many; `right` describes that list.
  void read(std::span<double> numbers, const char* right) const;
  [[nodiscard]] long long integer() const;
  [[nodiscard]] int integer_between(int lowest, int highest) const;
  [[nodiscard]] bool truth() const;
  [[nodiscard]] const std::string& text() const { return text("a string"); }
  [[nodiscard]] const std::string& text(const std::string& right) const;
  void expect_text(const std::string& right) const;
  /// The position of a text among `words`.
  [[nodiscard]] std::size_t choice(std::span<const char* const> words) const;
  [[nodiscard]] Eigen::Vector3d vector() const;
  [[nodiscard]] Eigen::Matrix3d rows() const;
  [[nodiscard]] std::map<std::string, std::string> texts() const;

  [[noreturn]] void refuse(const std::string& right) const;

 private:
  DocumentNode(const DocumentPart* part, const nlohmann::json& value)
      : part_(part), value_(&value) {}

  const DocumentPart* part_;
  const nlohmann::json* value_;
};

/// The value whose name by `to_string` the node contains.
template <typename Value, std::size_t N>
[[nodiscard]] Value choice(const DocumentNode& node, const std::array<Value, N>& values) {
  std::array<const char*, N> words;
  std::ranges::transform(values, words.begin(), [](Value value) { return to_string(value); });
  return values[node.choice(words)];
}

template <typename Value, std::size_t N>
[[nodiscard]] std::optional<Value> choice(const std::optional<DocumentNode>& node,
                                          const std::array<Value, N>& values) {
  if (!node) return std::nullopt;
  return choice(*node, values);
}

}  // namespace palpate::haptics
