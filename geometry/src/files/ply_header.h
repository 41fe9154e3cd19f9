// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "files/scalar_type.h"

namespace palpate::geometry {

struct PlyProperty {
  std::string name;
  Scalar type = Scalar::float32;
  std::optional<Scalar> list_size;  ///< type of the list length; empty if not a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  bool text = false;
  std::endian order = std::endian::little;
  std::vector<PlyElement> elements;
  std::vector<std::string> comments;  ///< including the text of obj_info
  std::size_t size = 0;               ///< bytes
};

/// Parses a header. Lines may end with \n, \r\n or \r.
/// \throws FileError naming the line that is not valid.
[[nodiscard]] PlyHeader parse_ply_header(std::string_view content, const std::string& file);

/// Name of a type in a header.
/// \throws InvalidInput for 64-bit integers, which PLY does not have.
[[nodiscard]] std::string_view ply_name(Scalar type);

}  // namespace palpate::geometry
