// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "palpate/documents/document.h"
#include "palpate/geometry/eigen_alignment.h"

namespace palpate::documents {

/// Largest magnitude of a number without a range of its own, in any unit. A larger one would be a
/// mistake, and the square of a smaller one is finite.
inline constexpr double kLargestDocumentNumber = 1e12;

/// The JSON pointer to a member of the object at `pointer`.
[[nodiscard]] std::string pointer_to(const std::string& pointer, const std::string& member);

/// \throws InvalidInput "at POINTER: found FOUND, expected RIGHT".
[[noreturn]] void refuse(const std::string& pointer, const std::string& found,
                         const std::string& right);

/// Typed access to a value inside a document, which must outlive the node. Every function throws
/// InvalidInput if the value is not of the requested kind. The message names the line, if it is
/// known, the JSON pointer, the value found, and what would be right: "line 3, at /tools/0/name:
/// found 5, expected a string".
class DocumentNode {
 public:
  explicit DocumentNode(const Document& document) : document_(&document), value_(&document.value) {}

  [[nodiscard]] DocumentNode at(const char* key) const;
  /// Nullopt if there is no such member.
  [[nodiscard]] std::optional<DocumentNode> find(const char* key) const;
  [[nodiscard]] std::vector<DocumentNode> items() const;
  /// Refuses an object with another member than these.
  void expect_only(std::span<const std::string> known) const;

  /// Finite and at most `kLargestDocumentNumber` in magnitude.
  [[nodiscard]] double number() const;
  [[nodiscard]] double number(const Interval& range, std::string_view unit) const;
  [[nodiscard]] double number_at_least_zero() const;
  [[nodiscard]] double number_above_zero() const;
  /// Fills `numbers` from a list of exactly as many; `right` describes that list.
  void read(std::span<double> numbers, const char* right) const;
  [[nodiscard]] long long integer() const;
  [[nodiscard]] int integer(const Interval& range) const;
  [[nodiscard]] int integer_between(int lowest, int highest) const;
  [[nodiscard]] bool truth() const;
  [[nodiscard]] const std::string& text() const { return text("a string"); }
  [[nodiscard]] const std::string& text(const std::string& right) const;
  void expect_text(const std::string& right) const;
  /// A text, number or truth value as it is written in YAML, or as JSON writes it; empty for null.
  [[nodiscard]] std::string word() const;
  /// The position of a text among `words`.
  [[nodiscard]] std::size_t choice(std::span<const char* const> words) const;
  [[nodiscard]] Eigen::Vector3d vector() const;
  [[nodiscard]] Eigen::Matrix3d rows() const;
  [[nodiscard]] std::map<std::string, std::string> texts() const;

  [[nodiscard]] const Json& value() const { return *value_; }
  /// Calls `read(name, node)` for each member of an object, in their order.
  void for_each_member(
      const std::function<void(const std::string& name, const DocumentNode& member)>& read) const;
  /// 0 if it is not known.
  [[nodiscard]] int line() const;

  [[noreturn]] void refuse(const std::string& right) const;
  /// \throws InvalidInput with the place and a sentence about the value.
  [[noreturn]] void fail(const std::string& what) const;
  /// Returns the result of `check`. An InvalidInput that it throws gets the place of this value.
  template <typename Check>
  auto checked(const Check& check) const {
    try {
      return check();
    } catch (const FileError&) {
      throw;
    } catch (const InvalidInput& wrong) {
      fail(wrong);
    }
  }

 private:
  DocumentNode(const Document* document, const Json& value) : document_(document), value_(&value) {}
  [[nodiscard]] std::string pointer() const;
  [[noreturn]] void fail(const InvalidInput& wrong) const;

  const Document* document_;
  const Json* value_;
};

/// Takes the members of an object one by one, and refuses the others at the end.
class DocumentMembers {
 public:
  /// \throws InvalidInput unless the node is an object.
  explicit DocumentMembers(const DocumentNode& object);

  [[nodiscard]] const DocumentNode& object() const { return object_; }
  /// Nullopt if there is no such member.
  [[nodiscard]] std::optional<DocumentNode> find(const char* name);
  /// \throws InvalidInput if there is no such member.
  [[nodiscard]] DocumentNode at(const char* name);
  /// Sets the values of members that are there.
  void take(const char* name, double& value, const Interval& range, std::string_view unit);
  void take(const char* name, int& value, const Interval& range);
  void take(const char* name, bool& value);
  void take(const char* name, Eigen::Vector3d& value);
  /// \throws InvalidInput that names a member that was not taken, and those that may be there.
  void end() const;

 private:
  DocumentNode object_;
  std::vector<std::string> known_;
};

/// Returns the result of `read`. An InvalidInput that it throws becomes a FileError that names
/// `source`.
template <typename Read>
auto in_file(const std::string& source, const Read& read) {
  try {
    return read();
  } catch (const FileError&) {
    throw;
  } catch (const InvalidInput& wrong) {
    throw FileError(source + ": " + wrong.what());
  }
}

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

}  // namespace palpate::documents
