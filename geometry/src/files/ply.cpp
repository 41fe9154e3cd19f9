// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "files/file_formats.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "files/ply_header.h"
#include "files/scalar_type.h"
#include "palpate/core/error.h"
#include "palpate/core/input_file.h"

namespace palpate::geometry {
namespace {

namespace fs = std::filesystem;

/// Reads the numbers behind the header one after the other, text or binary.
class Body {
 public:
  Body(std::string_view content, const PlyHeader& header, std::string file)
      : content_(content),
        rest_(content.substr(header.size)),
        text_(header.text),
        order_(header.order),
        file_(std::move(file)) {}

  /// Reads all rows of the next element, one attribute per property.
  Attributes read(const PlyElement& element) {
    element_ = &element;
    row_ = 0;
    Attributes columns;
    for (const PlyProperty& property : element.properties)
      columns.push_back({property.name, no_values(column_type(property)), {}});
    const std::uint64_t row_bytes = least_row_bytes();
    if (row_bytes == 0) return columns;  // the element has no properties
    check_count(row_bytes);
    const bool has_lists = std::any_of(element.properties.begin(), element.properties.end(),
                                       [](const auto& p) { return p.list_size.has_value(); });
    if (text_ || has_lists)
      read_rows(columns);
    else
      read_table(columns);
    return columns;
  }

 private:
  /// Text coordinates may have more digits than their type can hold.
  [[nodiscard]] Scalar column_type(const PlyProperty& property) const {
    const bool coordinate = element_->name == "vertex" && property.name.size() == 1 &&
                            std::string_view("xyz").find(property.name) != std::string_view::npos;
    return text_ && coordinate && !property.list_size ? Scalar::float64 : property.type;
  }

  /// An empty list still has its length; a number in a text needs at least a digit and a blank.
  [[nodiscard]] std::uint64_t least_row_bytes() const {
    std::uint64_t bytes = 0;
    for (const PlyProperty& property : element_->properties)
      bytes += text_ ? 2 : size_of(property.list_size.value_or(property.type));
    return bytes;
  }

  /// Checks, before allocating memory, that the file is long enough for this many rows.
  void check_count(std::uint64_t row_bytes) const {
    // The last number of a text may lack its blank.
    const std::uint64_t room = (rest_.size() + (text_ ? 1 : 0)) / row_bytes;
    if (element_->count > room)
      throw FileError(file_ + ": holds at most " + std::to_string(room) + " of " +
                      std::to_string(element_->count) + " rows of element " + element_->name +
                      "; it is truncated or its header is wrong");
  }

  /// Reads binary rows of fixed length, column by column.
  void read_table(Attributes& columns) {
    std::size_t row_bytes = 0;
    for (const Attribute& column : columns) row_bytes += size_of(type_of(column.values));
    std::size_t offset = 0;
    for (Attribute& column : columns) {
      reserve(column);
      append_loaded(column.values, order_, rest_.data() + offset, element_->count, row_bytes);
      offset += size_of(type_of(column.values));
    }
    rest_.remove_prefix(row_bytes * element_->count);
  }

  void read_rows(Attributes& columns) {
    Attributes sizes;  // of the current list, in the type of its count
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const PlyProperty& property = element_->properties[i];
      sizes.push_back({"size of list " + property.name,
                       no_values(property.list_size.value_or(Scalar::uint8)),
                       {}});
      reserve(columns[i]);
    }
    for (row_ = 0; row_ < element_->count; ++row_)
      for (std::size_t i = 0; i < columns.size(); ++i) {
        std::size_t count = 1;
        if (element_->properties[i].list_size) {
          count = next_list_size(sizes[i]);
          columns[i].list_sizes.push_back(static_cast<int>(count));
        }
        append(columns[i], count);
      }
  }

  void reserve(Attribute& column) const {
    std::visit([&](auto& numbers) { numbers.reserve(element_->count); }, column.values);
  }

  void append(Attribute& column, std::size_t count) {
    if (text_) {
      for (std::size_t i = 0; i < count; ++i) {
        const std::string_view word = next_number_word();
        if (!append_parsed(column.values, word))
          fail(line() + ": " + quoted(word) + " is not a number of type " +
               std::string(ply_name(type_of(column.values))) + " for property " + column.name);
      }
      return;
    }
    const std::size_t step = size_of(type_of(column.values));
    if (count > rest_.size() / step) fail_truncated();
    append_loaded(column.values, order_, rest_.data(), count, step);
    rest_.remove_prefix(count * step);
  }

  std::size_t next_list_size(Attribute& size) {
    append(size, 1);
    const auto count = std::visit(
        [](auto& numbers) {
          const auto number = static_cast<double>(numbers.back());
          numbers.clear();
          return number;
        },
        size.values);
    if (count < 0 || count > std::numeric_limits<int>::max())
      fail(size.name + " is " + std::to_string(static_cast<std::int64_t>(count)) +
           ", which is impossible");
    return static_cast<std::size_t>(count);
  }

  std::string_view next_number_word() {
    const std::string_view word = next_word(rest_);
    if (word.empty()) fail_truncated();
    return word;
  }

  [[nodiscard]] std::string line() const {
    return "line " + std::to_string(line_number(content_, content_.size() - rest_.size()));
  }

  [[noreturn]] void fail(const std::string& reason) const {
    throw FileError(file_ + ": " + element_->name + " " + std::to_string(row_) + " of " +
                    std::to_string(element_->count) + ": " + reason);
  }

  [[noreturn]] void fail_truncated() const {
    fail("the file ends here (" + std::to_string(row_) + " of " + std::to_string(element_->count) +
         " are whole); it is truncated or its header is wrong");
  }

  std::string_view content_;
  std::string_view rest_;
  bool text_;
  std::endian order_;
  std::string file_;
  const PlyElement* element_ = nullptr;
  std::uint64_t row_ = 0;
};

void take_vertices(Attributes columns, const std::string& file, PolygonMesh& mesh) {
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const std::string name(1, "xyz"[axis]);
    const std::optional<Eigen::VectorXd> coordinates = scalars(columns, name);
    if (!coordinates) throw FileError(file + ": element vertex needs one property " + "xyz"[axis]);
    mesh.vertices.resize(static_cast<std::size_t>(coordinates->size()));
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
      mesh.vertices[i][axis] = (*coordinates)[static_cast<Eigen::Index>(i)];
    std::erase_if(columns, [&](const Attribute& column) { return column.name == name; });
  }
  mesh.vertex_attributes = std::move(columns);
}

bool is_polygon(const std::string& name) {
  return name == "vertex_indices" || name == "vertex_index";
}

/// Moves the vertex indices of a row out of its columns.
Attribute take_indices(Attributes& columns, const PlyElement& element, const std::string& file) {
  const auto& properties = element.properties;
  const auto found = std::find_if(properties.begin(), properties.end(),
                                  [](const auto& property) { return is_polygon(property.name); });
  if (found == properties.end() || !found->list_size || !is_integer(found->type) ||
      std::count_if(properties.begin(), properties.end(),
                    [](const auto& property) { return is_polygon(property.name); }) != 1)
    throw FileError(file + ": element " + element.name +
                    " needs one list vertex_indices of integers");
  const auto column = columns.begin() + (found - properties.begin());
  Attribute indices = std::move(*column);
  columns.erase(column);
  return indices;
}

std::vector<std::int64_t> whole_numbers(const AttributeValues& values) {
  return std::visit(
      [](const auto& numbers) {
        std::vector<std::int64_t> result;
        result.reserve(numbers.size());
        for (const auto number : numbers) result.push_back(static_cast<std::int64_t>(number));
        return result;
      },
      values);
}

/// Every vertex of a strip but the first two forms a triangle with the two before it; every other
/// triangle is reversed so that all have the same orientation. -1 starts a new strip.
void take_strip(std::span<const std::int64_t> strip, PolygonMesh& mesh) {
  std::size_t first = 0;
  for (std::size_t i = 0; i < strip.size(); ++i) {
    if (strip[i] == -1) first = i + 1;
    if (i < first + 2) continue;
    const bool turned = (i - first) % 2 == 1;
    mesh.corners.insert(mesh.corners.end(),
                        {strip[turned ? i - 1 : i - 2], strip[turned ? i - 2 : i - 1], strip[i]});
    mesh.sizes.push_back(3);
  }
}

void take_strips(const Attribute& strips, PolygonMesh& mesh) {
  const std::vector<std::int64_t> indices = whole_numbers(strips.values);
  std::span<const std::int64_t> rest = indices;
  for (const int size : strips.list_sizes) {
    take_strip(rest.first(static_cast<std::size_t>(size)), mesh);
    rest = rest.subspan(static_cast<std::size_t>(size));
  }
}

}  // namespace

PolygonMesh read_ply(std::string_view content, const std::string& file) {
  PlyHeader header = parse_ply_header(content, file);
  Body body(content, header, file);
  PolygonMesh mesh;
  mesh.comments = std::move(header.comments);
  Attribute strips;
  for (const PlyElement& element : header.elements) {
    Attributes columns = body.read(element);
    if (element.name == "vertex") {
      take_vertices(std::move(columns), file, mesh);
    } else if (element.name == "face" && element.count > 0) {
      const Attribute polygons = take_indices(columns, element, file);
      mesh.corners = whole_numbers(polygons.values);
      mesh.sizes = polygons.list_sizes;
      mesh.face_attributes = std::move(columns);
    } else if (element.name == "tristrips" && element.count > 0) {
      strips = take_indices(columns, element, file);
    }
  }
  if (!strips.list_sizes.empty()) {
    mesh.face_attributes.clear();
    take_strips(strips, mesh);
  }
  return mesh;
}

}  // namespace palpate::geometry
