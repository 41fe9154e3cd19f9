// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace palpate::geometry {

/// Numbers in one of the types that files hold.
using AttributeValues =
    std::variant<std::vector<std::int8_t>, std::vector<std::uint8_t>, std::vector<std::int16_t>,
                 std::vector<std::uint16_t>, std::vector<std::int32_t>, std::vector<std::uint32_t>,
                 std::vector<std::int64_t>, std::vector<std::uint64_t>, std::vector<float>,
                 std::vector<double>>;

/// A named quantity of every vertex, triangle or point, in the type that it has in its file: what
/// is read and written again has every bit of it.
///
/// Whatever the format, normals are called nx, ny, nz, and colours red, green, blue, alpha.
struct Attribute {
  std::string name;             ///< one word
  AttributeValues values;       ///< one number an element; of lists, one list after the other
  std::vector<int> list_sizes;  ///< numbers of each element; empty: one each
};

using Attributes = std::vector<Attribute>;

/// How many elements an attribute has values of.
[[nodiscard]] Eigen::Index element_count(const Attribute& attribute);

/// The attribute of that name; null if there is none.
[[nodiscard]] const Attribute* find_attribute(const Attributes& attributes, std::string_view name);

/// An attribute as double, one number an element; nullopt if there is none of that name or it holds
/// lists. Integers beyond 2^53 are rounded.
[[nodiscard]] std::optional<Eigen::VectorXd> scalars(const Attributes& attributes,
                                                     std::string_view name);

/// Normals as they are, 3 x N; nullopt unless there are nx, ny and nz.
[[nodiscard]] std::optional<Eigen::Matrix3Xd> normals(const Attributes& attributes);

/// Red, green, blue and alpha, 4 x N: an integer is divided by the greatest of its type, a floating
/// point number taken as it is; alpha is 1 where there is none. Nullopt unless there are red, green
/// and blue.
[[nodiscard]] std::optional<Eigen::Matrix4Xd> colors(const Attributes& attributes);

/// Adds an attribute, or replaces the one of its name.
void set_attribute(Attributes& attributes, Attribute attribute);

/// Adds or replaces nx, ny and nz, in double.
void set_normals(Attributes& attributes, const Eigen::Ref<const Eigen::Matrix3Xd>& normals);

/// Adds or replaces red, green, blue (3 x N) and alpha (4 x N), each rounded to one byte.
/// \throws InvalidInput unless there are 3 or 4 rows and every number is in [0, 1].
void set_colors(Attributes& attributes, const Eigen::Ref<const Eigen::MatrixXd>& colors);

/// Checks that names are different words and that each attribute is of `elements` elements.
/// \throws InvalidInput naming `what`, the attribute, and what is wrong with it.
void check_attributes(const Attributes& attributes, Eigen::Index elements, const char* what);

}  // namespace palpate::geometry
