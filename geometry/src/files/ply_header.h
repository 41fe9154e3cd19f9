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
  std::optional<Scalar> list_size;  ///< type of the count, if it is a list
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
  std::vector<std::string> comments;  ///< and what stands behind obj_info
  std::size_t size = 0;               ///< bytes
};

/// Lines may end with \n, \r\n or \r.
/// \throws FileError naming the line that is wrong.
[[nodiscard]] PlyHeader parse_ply_header(std::string_view content, const std::string& file);

/// The name of a type in a header.
/// \throws InvalidInput for the integers of 64 bits, which PLY does not know.
[[nodiscard]] std::string_view ply_name(Scalar type);

}  // namespace palpate::geometry
