// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <limits>
#include <ostream>
#include <string>

#include "files/file_formats.h"
#include "files/file_unit.h"
#include "files/ply_header.h"
#include "files/scalar_type.h"
#include "palpate/core/error.h"

namespace palpate::geometry {
namespace {

/// Writes the numbers of rows as text or bytes.
class Rows {
 public:
  Rows(std::string& bytes, Encoding encoding)
      : bytes_(bytes),
        text_(encoding == Encoding::text),
        order_(encoding == Encoding::binary_big_endian ? std::endian::big : std::endian::little) {}

  template <typename Number>
  void put(Number number) {
    if (text_) {
      append_digits(bytes_, number);
      bytes_ += ' ';
    } else {
      append_bytes(bytes_, order_, number);
    }
  }

  void put(const AttributeValues& values, std::size_t index) {
    std::visit([&](const auto& numbers) { put(numbers[index]); }, values);
  }

  void end_row() {
    if (text_) bytes_.back() = '\n';
  }

 private:
  std::string& bytes_;
  bool text_;
  std::endian order_;
};

constexpr int kMaxShortList = std::numeric_limits<std::uint8_t>::max();

bool has_short_lists(const Attribute& attribute) {
  return std::all_of(attribute.list_sizes.begin(), attribute.list_sizes.end(),
                     [](int size) { return size <= kMaxShortList; });
}

/// Writes the values of an attribute, element by element.
class Column {
 public:
  explicit Column(const Attribute& attribute)
      : attribute_(attribute), short_lists_(has_short_lists(attribute)) {}

  void put_next(Rows& rows) {
    if (attribute_.list_sizes.empty()) {
      rows.put(attribute_.values, next_++);
      return;
    }
    const int size = attribute_.list_sizes[element_++];
    if (short_lists_)
      rows.put(static_cast<std::uint8_t>(size));
    else
      rows.put(size);
    for (int i = 0; i < size; ++i) rows.put(attribute_.values, next_++);
  }

 private:
  const Attribute& attribute_;
  bool short_lists_;
  std::size_t next_ = 0;
  std::size_t element_ = 0;
};

std::string property_lines(const Attributes& attributes) {
  std::string lines;
  for (const Attribute& attribute : attributes) {
    lines += "property ";
    if (!attribute.list_sizes.empty())
      lines += has_short_lists(attribute) ? "list uchar " : "list int ";
    lines += std::string(ply_name(type_of(attribute.values))) + " " + attribute.name + "\n";
  }
  return lines;
}

std::string header_of(const MeshFile& file, const WriteOptions& options) {
  const Encoding encoding = options.encoding;
  std::string header = "ply\nformat ";
  header += encoding == Encoding::text                ? "ascii"
            : encoding == Encoding::binary_big_endian ? "binary_big_endian"
                                                      : "binary_little_endian";
  header += " 1.0\ncomment " + std::string(kUnitComment) + "\n";
  for (const std::string& comment : file.comments) header += "comment " + comment + "\n";
  header += "element vertex " + std::to_string(file.mesh.vertices.cols()) + "\n";
  for (const char* axis : {" x\n", " y\n", " z\n"})
    header += std::string(options.single_precision ? "property float" : "property double") + axis;
  header += property_lines(file.vertex_attributes);
  if (file.mesh.triangles.cols() > 0)
    header += "element face " + std::to_string(file.mesh.triangles.cols()) +
              "\nproperty list uchar int vertex_indices\n" +
              property_lines(file.triangle_attributes);
  return header + "end_header\n";
}

void check_names(const Attributes& attributes, std::initializer_list<const char*> taken,
                 const char* what) {
  for (const char* name : taken)
    if (find_attribute(attributes, name) != nullptr)
      throw InvalidInput(std::string(what) + ": an attribute is called \"" + name +
                         "\", which PLY needs itself; give it another name");
}

}  // namespace

void write_ply(std::ostream& stream, const MeshFile& file, const WriteOptions& options,
               const char* what) {
  check_names(file.vertex_attributes, {"x", "y", "z"}, what);
  check_names(file.triangle_attributes, {"vertex_indices", "vertex_index"}, what);
  std::string bytes = header_of(file, options);
  // Exact for a binary file without attributes; otherwise it avoids some copies.
  bytes.reserve(
      bytes.size() + sizeof(double) * static_cast<std::size_t>(file.mesh.vertices.size()) +
      (1 + 3 * sizeof(std::int32_t)) * static_cast<std::size_t>(file.mesh.triangles.cols()));
  Rows rows(bytes, options.encoding);
  std::vector<Column> of_vertex(file.vertex_attributes.begin(), file.vertex_attributes.end());
  for (const auto& vertex : file.mesh.vertices.colwise()) {
    for (const double coordinate : vertex) {
      if (options.single_precision)
        rows.put(static_cast<float>(coordinate));
      else
        rows.put(coordinate);
    }
    for (Column& column : of_vertex) column.put_next(rows);
    rows.end_row();
  }
  std::vector<Column> of_triangle(file.triangle_attributes.begin(), file.triangle_attributes.end());
  for (const auto& triangle : file.mesh.triangles.colwise()) {
    rows.put(std::uint8_t{3});
    for (const int corner : triangle) rows.put(std::int32_t{corner});
    for (Column& column : of_triangle) column.put_next(rows);
    rows.end_row();
  }
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace palpate::geometry
