// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "files/ply_header.h"

#include <algorithm>
#include <array>

#include "palpate/core/error.h"
#include "palpate/core/input_file.h"

namespace palpate::geometry {
namespace {

struct TypeName {
  std::string_view old_name, new_name;
  Scalar type;
};

constexpr std::array<TypeName, 8> kTypeNames{{{"char", "int8", Scalar::int8},
                                              {"uchar", "uint8", Scalar::uint8},
                                              {"short", "int16", Scalar::int16},
                                              {"ushort", "uint16", Scalar::uint16},
                                              {"int", "int32", Scalar::int32},
                                              {"uint", "uint32", Scalar::uint32},
                                              {"float", "float32", Scalar::float32},
                                              {"double", "float64", Scalar::float64}}};

std::optional<Scalar> scalar_of(std::string_view name) {
  for (const TypeName& known : kTypeNames)
    if (name == known.old_name || name == known.new_name) return known.type;
  return std::nullopt;
}

/// One line `property ...` without its first word; nullopt if it is not understood.
std::optional<PlyProperty> parse_property(std::string_view words) {
  PlyProperty property;
  std::string_view type = next_word(words);
  if (type == "list") {
    property.list_size = scalar_of(next_word(words));
    if (!property.list_size || !is_integer(*property.list_size)) return std::nullopt;
    type = next_word(words);
  }
  const std::optional<Scalar> scalar = scalar_of(type);
  property.name = next_word(words);
  if (!scalar || property.name.empty()) return std::nullopt;
  property.type = *scalar;
  return property;
}

/// Adds a property unless there is one of its name.
bool add_property(const std::optional<PlyProperty>& property, PlyElement& element) {
  if (!property || std::any_of(element.properties.begin(), element.properties.end(),
                               [&](const auto& p) { return p.name == property->name; }))
    return false;
  element.properties.push_back(*property);
  return true;
}

/// Takes over one line of the header; false if it is not understood.
bool parse_line(std::string_view line, PlyHeader& header) {
  const std::string_view keyword = next_word(line);
  if (keyword.empty()) return true;
  if (keyword == "comment" || keyword == "obj_info") {
    header.comments.emplace_back(line.substr(std::min<std::size_t>(1, line.size())));
    return true;
  }
  if (keyword == "format") {
    const std::string_view format = next_word(line);
    header.text = format == "ascii";
    header.order = format == "binary_big_endian" ? std::endian::big : std::endian::little;
    return header.text || format == "binary_big_endian" || format == "binary_little_endian";
  }
  if (keyword == "element") {
    const std::string_view name = next_word(line);
    const auto count = parse_number<std::uint64_t>(next_word(line));
    const bool is_new = std::none_of(header.elements.begin(), header.elements.end(),
                                     [&](const auto& e) { return e.name == name; });
    if (count && is_new) header.elements.push_back({std::string(name), *count, {}});
    return count && is_new;
  }
  if (keyword == "property" && !header.elements.empty())
    return add_property(parse_property(line), header.elements.back());
  return false;
}

/// Takes the first line off `rest`, without its end.
std::string_view next_header_line(std::string_view& rest, bool ends_with_return) {
  if (!ends_with_return) return next_line(rest);
  const std::string_view line = rest.substr(0, rest.find('\r'));
  rest.remove_prefix(std::min(line.size() + 1, rest.size()));
  return line;
}

}  // namespace

PlyHeader parse_ply_header(std::string_view content, const std::string& file) {
  std::string_view rest = content;
  const bool ends_with_return = content.starts_with("ply\r") && !content.starts_with("ply\r\n");
  if (next_header_line(rest, ends_with_return) != "ply")
    throw FileError(file + ": is not a PLY file; its first line must be \"ply\"");
  PlyHeader header;
  bool has_format = false;
  for (int number = 2; !rest.empty(); ++number) {
    const std::string_view line = next_header_line(rest, ends_with_return);
    header.size = content.size() - rest.size();
    if (line == "end_header") {
      if (!has_format) throw FileError(file + ": its header has no line \"format ...\"");
      return header;
    }
    if (!parse_line(line, header))
      throw FileError(file + ": line " + std::to_string(number) +
                      " of the header is not valid, or repeats an earlier line: " + quoted(line));
    has_format = has_format || line.starts_with("format");
  }
  throw FileError(file + ": its header has no line \"end_header\"; the file is truncated");
}

std::string_view ply_name(Scalar type) {
  for (const TypeName& known : kTypeNames)
    if (type == known.type) return known.old_name;
  throw InvalidInput("PLY has no 64-bit integers; use int32, uint32 or float64");
}

}  // namespace palpate::geometry
