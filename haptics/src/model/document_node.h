// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace palpate::haptics {

/// [mm, N, ...] No number of a document is further from zero: it would be a mistake, and its square
/// would still be finite.
inline constexpr double kLargestNumber = 1e12;

/// A value of a JSON document that is being read. Each function throws InvalidInput unless the
/// value is what it asks for: with the JSON pointer, what was found, and what would be right. The
/// document must outlive it.
class DocumentNode {
 public:
  explicit DocumentNode(const nlohmann::json& document) : root_(&document), value_(&document) {}

  [[nodiscard]] DocumentNode at(const char* key) const;
  /// Nullopt if there is no such member.
  [[nodiscard]] std::optional<DocumentNode> find(const char* key) const;
  [[nodiscard]] std::vector<DocumentNode> items() const;

  /// Finite and at most `kLargestNumber` in size.
  [[nodiscard]] double number() const;
  [[nodiscard]] double number_at_least_zero() const;
  [[nodiscard]] double number_above_zero() const;
  [[nodiscard]] long long integer() const;
  [[nodiscard]] int integer_between(int lowest, int highest) const;
  [[nodiscard]] bool truth() const;
  [[nodiscard]] const std::string& text() const;
  void expect_text(const std::string& right) const;
  /// The position of a text among `words`.
  [[nodiscard]] std::size_t choice(std::span<const char* const> words) const;
  [[nodiscard]] Eigen::Vector3d vector() const;
  [[nodiscard]] Eigen::Matrix3d rows() const;
  [[nodiscard]] std::map<std::string, std::string> texts() const;

  [[noreturn]] void refuse(const std::string& right) const;

 private:
  DocumentNode(const nlohmann::json* root, const nlohmann::json& value)
      : root_(root), value_(&value) {}

  const nlohmann::json* root_;  ///< where the pointer to a refused value begins
  const nlohmann::json* value_;
};

}  // namespace palpate::haptics
