// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "ply.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>

#include "binary_scalar.h"
#include "input_file.h"
#include "palpate/error.h"

namespace palpate::geometry {
namespace {

namespace fs = std::filesystem;

struct Property {
  std::string name;
  Scalar type = Scalar::float32;
  std::optional<Scalar> list_size;  ///< type of the count, if it is a list
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  bool text = false;
  std::endian order = std::endian::little;
  std::vector<Element> elements;
  std::size_t size = 0;  ///< bytes
};

std::optional<Scalar> scalar_of(std::string_view name) {
  struct Name {
    std::string_view old_name, new_name;
    Scalar type;
  };
  static constexpr std::array<Name, 8> kNames{{{"char", "int8", Scalar::int8},
                                               {"uchar", "uint8", Scalar::uint8},
                                               {"short", "int16", Scalar::int16},
                                               {"ushort", "uint16", Scalar::uint16},
                                               {"int", "int32", Scalar::int32},
                                               {"uint", "uint32", Scalar::uint32},
                                               {"float", "float32", Scalar::float32},
                                               {"double", "float64", Scalar::float64}}};
  for (const Name& known : kNames)
    if (name == known.old_name || name == known.new_name) return known.type;
  return std::nullopt;
}

/// One line `property ...` without its first word; nullopt if it is not understood.
std::optional<Property> parse_property(std::string_view words) {
  Property property;
  std::string_view type = next_word(words);
  if (type == "list") {
    property.list_size = scalar_of(next_word(words));
    if (!property.list_size || *property.list_size == Scalar::float32 ||
        *property.list_size == Scalar::float64)
      return std::nullopt;
    type = next_word(words);
  }
  const std::optional<Scalar> scalar = scalar_of(type);
  property.name = next_word(words);
  if (!scalar || property.name.empty()) return std::nullopt;
  property.type = *scalar;
  return property;
}

/// Takes over one line of the header; false if it is not understood.
bool parse_header_line(std::string_view line, Header& header) {
  const std::string_view keyword = next_word(line);
  if (keyword.empty() || keyword == "comment" || keyword == "obj_info") return true;
  if (keyword == "format") {
    const std::string_view format = next_word(line);
    header.text = format == "ascii";
    header.order = format == "binary_big_endian" ? std::endian::big : std::endian::little;
    return header.text || format == "binary_big_endian" || format == "binary_little_endian";
  }
  if (keyword == "element") {
    const std::string_view name = next_word(line);
    const auto count = parse_number<std::uint64_t>(next_word(line));
    if (count) header.elements.push_back({std::string(name), *count, {}});
    return count.has_value();
  }
  if (keyword == "property" && !header.elements.empty()) {
    const std::optional<Property> property = parse_property(line);
    if (property) header.elements.back().properties.push_back(*property);
    return property.has_value();
  }
  return false;
}

Header parse_header(std::string_view content, const std::string& file) {
  std::string_view rest = content;
  if (next_line(rest) != "ply")
    throw FileError(file + ": is not a PLY file; its first line must be \"ply\"");
  Header header;
  bool has_format = false;
  while (!rest.empty()) {
    const std::size_t offset = content.size() - rest.size();
    const std::string_view line = next_line(rest);
    header.size = content.size() - rest.size();
    if (line == "end_header") {
      if (!has_format) throw FileError(file + ": its header has no line \"format ...\"");
      return header;
    }
    if (!parse_header_line(line, header))
      throw FileError(file + ": line " + std::to_string(line_number(content, offset)) +
                      " of the header is not understood: " + quoted(line));
    has_format = has_format || line.starts_with("format");
  }
  throw FileError(file + ": its header has no line \"end_header\"; the file is truncated");
}

/// Reads the numbers behind the header one after the other, text or binary.
class Body {
 public:
  Body(std::string_view content, const Header& header, std::string file)
      : content_(content),
        rest_(content.substr(header.size)),
        text_(header.text),
        order_(header.order),
        file_(std::move(file)) {}

  /// Names the row that is read now, for messages.
  void enter(const Element& element, std::uint64_t row) {
    element_ = &element;
    row_ = row;
  }

  /// Before memory is taken for `count` numbers: they can only be there if the file is long enough.
  void expect(std::uint64_t count, Scalar type) const {
    // In a text each takes a digit and a blank, but for the last blank.
    if (count > (text_ ? rest_.size() / 2 + 1 : rest_.size() / size_of(type))) fail_truncated();
  }

  double next(Scalar type) {
    if (text_) return next_in_text();
    if (rest_.size() < size_of(type)) fail_truncated();
    const double value = load(type, order_, rest_.data());
    rest_.remove_prefix(size_of(type));
    return value;
  }

  std::uint64_t next_list_size(const Property& list) {
    const double size = next(*list.list_size);
    // Text may say anything, also what no integer type holds.
    if (!(size >= 0 && size <= std::numeric_limits<int>::max() && size == std::floor(size)))
      fail("property " + list.name + " is a list of impossible size " + std::to_string(size));
    const auto count = static_cast<std::uint64_t>(size);
    expect(count, list.type);
    return count;
  }

  [[noreturn]] void fail(const std::string& reason) const {
    throw FileError(file_ + ": " + element_->name + " " + std::to_string(row_) + " of " +
                    std::to_string(element_->count) + ": " + reason);
  }

  [[noreturn]] void fail_truncated() const {
    fail("the file ends here (" + std::to_string(row_) + " of " + std::to_string(element_->count) +
         " are whole); it is truncated or its header is wrong");
  }

 private:
  double next_in_text() {
    const std::string_view word = next_word(rest_);
    if (word.empty()) fail_truncated();
    const std::optional<double> number = parse_number<double>(word);
    if (!number)
      fail("line " + std::to_string(line_number(content_, content_.size() - rest_.size())) + ": " +
           quoted(word) + " is not a number");
    return *number;
  }

  std::string_view content_;
  std::string_view rest_;
  bool text_;
  std::endian order_;
  std::string file_;
  const Element* element_ = nullptr;
  std::uint64_t row_ = 0;
};

/// Bytes that a row of a binary file takes at least: its lists may be empty.
std::uint64_t min_row_bytes(const Element& element) {
  std::uint64_t bytes = 0;
  for (const Property& property : element.properties)
    bytes += size_of(property.list_size.value_or(property.type));
  return bytes;
}

void check_count(const Element& element, const Header& header, std::size_t file_size,
                 const std::string& file) {
  const std::uint64_t row = header.text ? 2 * element.properties.size() : min_row_bytes(element);
  const std::uint64_t room = file_size - header.size + 1;  // the last line may lack its end
  if (row > 0 && element.count > room / row)
    throw FileError(file + ": holds at most " + std::to_string(room / row) + " of " +
                    std::to_string(element.count) + " rows of element " + element.name +
                    "; it is truncated or its header is wrong");
}

void skip(Body& body, const Property& property) {
  const std::uint64_t count = property.list_size ? body.next_list_size(property) : 1;
  for (std::uint64_t i = 0; i < count; ++i) body.next(property.type);
}

void read_vertices(Body& body, const Element& element, const std::string& file, PolygonMesh& mesh) {
  std::vector<int> axes;  // of each property; -1: skipped
  for (const Property& property : element.properties) {
    const std::size_t axis = std::string_view("xyz").find(property.name);
    const bool coordinate = property.name.size() == 1 && axis < 3 && !property.list_size;
    axes.push_back(coordinate ? static_cast<int>(axis) : -1);
  }
  for (int axis = 0; axis < 3; ++axis)
    if (std::count(axes.begin(), axes.end(), axis) != 1)
      throw FileError(file + ": element vertex needs one property " + "xyz"[axis]);
  mesh.vertices.reserve(element.count);
  for (std::uint64_t row = 0; row < element.count; ++row) {
    body.enter(element, row);
    Eigen::Vector3d vertex;
    for (std::size_t i = 0; i < axes.size(); ++i)
      if (axes[i] < 0)
        skip(body, element.properties[i]);
      else
        vertex[axes[i]] = body.next(element.properties[i].type);
    mesh.vertices.push_back(vertex);
  }
}

void read_polygon(Body& body, const Property& list, PolygonMesh& mesh) {
  const std::uint64_t size = body.next_list_size(list);
  for (std::uint64_t i = 0; i < size; ++i) {
    const double index = body.next(list.type);
    if (index != std::floor(index) || std::abs(index) > std::numeric_limits<std::int32_t>::max())
      body.fail("corner " + std::to_string(i) + " is not the number of a vertex");
    mesh.corners.push_back(static_cast<std::int64_t>(index));
  }
  mesh.sizes.push_back(static_cast<int>(size));
}

void read_faces(Body& body, const Element& element, const std::string& file, PolygonMesh& mesh) {
  const auto is_polygon = [](const Property& property) {
    return property.list_size && property.type != Scalar::float32 &&
           property.type != Scalar::float64 &&
           (property.name == "vertex_indices" || property.name == "vertex_index");
  };
  if (std::count_if(element.properties.begin(), element.properties.end(), is_polygon) != 1)
    throw FileError(file + ": element face needs one list vertex_indices of integers");
  mesh.sizes.reserve(element.count);
  for (std::uint64_t row = 0; row < element.count; ++row) {
    body.enter(element, row);
    for (const Property& property : element.properties)
      if (is_polygon(property))
        read_polygon(body, property, mesh);
      else
        skip(body, property);
  }
}

}  // namespace

PolygonMesh read_ply(const fs::path& path) {
  const std::string content = read_input_file(path);
  const std::string file = path.string();
  const Header header = parse_header(content, file);
  Body body(content, header, file);
  PolygonMesh mesh;
  for (const Element& element : header.elements) {
    check_count(element, header, content.size(), file);
    if (element.name == "vertex") {
      read_vertices(body, element, file, mesh);
    } else if (element.name == "face" && element.count > 0) {
      read_faces(body, element, file, mesh);
    } else if (!element.properties.empty()) {
      for (std::uint64_t row = 0; row < element.count; ++row) {
        body.enter(element, row);
        for (const Property& property : element.properties) skip(body, property);
      }
    }
  }
  return mesh;
}

void write_ply(std::ostream& stream, const TriangleMesh& mesh) {
  std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                      std::to_string(mesh.vertices.cols()) +
                      "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
                      std::to_string(mesh.triangles.cols()) +
                      "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const double coordinate : mesh.vertices.reshaped()) append_little_endian(bytes, coordinate);
  for (Eigen::Index i = 0; i < mesh.triangles.cols(); ++i) {
    bytes += '\3';
    for (int corner = 0; corner < 3; ++corner)
      append_little_endian(bytes, mesh.triangles(corner, i));
  }
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace palpate::geometry
