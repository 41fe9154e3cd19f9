// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::geometry {

/// Values in one of the number types that files support.
using AttributeValues =
    std::variant<std::vector<std::int8_t>, std::vector<std::uint8_t>, std::vector<std::int16_t>,
                 std::vector<std::uint16_t>, std::vector<std::int32_t>, std::vector<std::uint32_t>,
                 std::vector<std::int64_t>, std::vector<std::uint64_t>, std::vector<float>,
                 std::vector<double>>;

/// A named quantity of every vertex, triangle or point. It keeps the number type of its file, so
/// that reading and writing preserves every bit.
///
/// In all formats normals are named nx, ny, nz and colours red, green, blue, alpha.
struct Attribute {
  std::string name;             ///< one word
  AttributeValues values;       ///< one number per element; for lists, one list after the other
  std::vector<int> list_sizes;  ///< length of each element's list; empty if there are no lists
};

using Attributes = std::vector<Attribute>;

/// Number of elements of an attribute.
[[nodiscard]] Eigen::Index element_count(const Attribute& attribute);

/// Finds an attribute by name; null if there is none.
[[nodiscard]] const Attribute* find_attribute(const Attributes& attributes, std::string_view name);

/// Converts an attribute to double, one number per element; nullopt if there is none of that name
/// or it holds lists. Integers beyond 2^53 are rounded.
[[nodiscard]] std::optional<Eigen::VectorXd> scalars(const Attributes& attributes,
                                                     std::string_view name);

/// Normals without normalisation, 3 x N; nullopt unless nx, ny and nz exist.
[[nodiscard]] std::optional<Eigen::Matrix3Xd> normals(const Attributes& attributes);

/// Red, green, blue and alpha, 4 x N. Integers are divided by the largest value of their type,
/// floating point numbers are returned unchanged, and a missing alpha is 1. Nullopt unless red,
/// green and blue exist.
[[nodiscard]] std::optional<Eigen::Matrix4Xd> colors(const Attributes& attributes);

/// The same, each rounded to one byte, for programs that take no others: numbers outside [0, 1]
/// count as the nearer end, NaN as 0.
[[nodiscard]] std::optional<Eigen::Matrix<std::uint8_t, 4, Eigen::Dynamic>> color_bytes(
    const Attributes& attributes);

/// Adds an attribute, or replaces the one with the same name.
void set_attribute(Attributes& attributes, Attribute attribute);

/// Adds or replaces nx, ny and nz, in double.
void set_normals(Attributes& attributes, const Eigen::Ref<const Eigen::Matrix3Xd>& normals);

/// Adds or replaces red, green, blue (3 x N) and alpha (4 x N), each rounded to one byte.
/// \throws InvalidInput unless there are 3 or 4 rows and every number is in [0, 1].
void set_colors(Attributes& attributes, const Eigen::Ref<const Eigen::MatrixXd>& colors);

/// Checks that names are distinct words and that each attribute has `elements` elements.
/// \throws InvalidInput naming `what`, the attribute, and what is wrong with it.
void check_attributes(const Attributes& attributes, Eigen::Index elements, const char* what);

}  // namespace palpate::geometry
