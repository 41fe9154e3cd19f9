// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "files/file_formats.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "palpate/core/error.h"
#include "palpate/core/input_file.h"

namespace palpate::geometry {
namespace {

namespace fs = std::filesystem;

/// The lines of an OFF file without blank lines and comments; comments are added to `comments`.
class OffLines {
 public:
  OffLines(std::string_view content, std::string file, std::vector<std::string>& comments)
      : content_(content), rest_(content), file_(std::move(file)), comments_(comments) {}

  /// The next line that holds something; empty at the end of the file.
  std::string_view next() {
    while (!rest_.empty()) {
      offset_ = content_.size() - rest_.size();
      std::string_view line = next_line(rest_);
      if (const std::size_t comment = line.find('#'); comment != std::string_view::npos) {
        const std::string_view text = line.substr(comment + 1);
        comments_.emplace_back(text.substr(text.starts_with(' ') ? 1 : 0));
        line = line.substr(0, comment);
      }
      std::string_view words = line;
      if (!next_word(words).empty()) return line;
    }
    return {};
  }

  /// The same, for row `row` of `count`, which must exist.
  std::string_view next_row(const char* what, std::uint64_t row, std::uint64_t count) {
    const std::string_view line = next();
    if (line.empty())
      throw FileError(file_ + ": holds " + std::to_string(row) + " of " + std::to_string(count) +
                      " " + what + "; it is truncated or its header is wrong");
    return line;
  }

  template <typename Number>
  Number number(std::string_view& words) const {
    const std::string_view word = next_word(words);
    const std::optional<Number> value = parse_number<Number>(word);
    if (!value) fail(quoted(word) + " is not a number of the kind that is needed here");
    return *value;
  }

  [[noreturn]] void fail(const std::string& reason) const {
    throw FileError(file_ + ": line " + std::to_string(line_number(content_, offset_)) + ": " +
                    reason);
  }

 private:
  std::string_view content_;
  std::string_view rest_;
  std::string file_;
  std::vector<std::string>& comments_;
  std::size_t offset_ = 0;
};

/// Per-vertex data after the coordinates, declared by the first word, in this order.
struct Layout {
  bool normals = false;
  bool colors = false;
  bool texture = false;
};

/// Removes the first word from `line`. The letters 4 and n would change the meaning of a
/// coordinate.
Layout take_magic(std::string_view& line, const std::string& file) {
  const std::string_view magic = next_word(line);
  const std::size_t prefix = magic.find("OFF");
  if (prefix == std::string_view::npos || magic.size() != prefix + 3 ||
      magic.substr(0, prefix).find_first_not_of("STCN") != std::string_view::npos)
    throw FileError(file + ": is not a text OFF file; its first word must be OFF, not " +
                    quoted(magic));
  const auto announces = [&](char letter) { return magic.find(letter) < prefix; };
  return {.normals = announces('N'), .colors = announces('C'), .texture = announces('T')};
}

std::size_t count_words(std::string_view line) {
  std::size_t count = 0;
  while (!next_word(line).empty()) ++count;
  return count;
}

/// The columns after the coordinates. The first line determines the number of colour channels.
class VertexColumns {
 public:
  explicit VertexColumns(const Layout& layout) : layout_(layout) {}

  void take(std::string_view words, const OffLines& lines) {
    if (columns_.empty()) name_columns(words);
    complete_ = complete_ && count_words(words) >= columns_.size();
    for (std::size_t i = 0; complete_ && i < columns_.size(); ++i)
      columns_[i].values.push_back(lines.number<double>(words));
  }

  /// Empty unless every vertex has all declared data.
  [[nodiscard]] Attributes result() const {
    Attributes attributes;
    if (!complete_) return attributes;
    const bool as_bytes = has_byte_colors();
    for (const Column& column : columns_) {
      if (column.is_color && as_bytes)
        attributes.push_back({column.name,
                              std::vector<std::uint8_t>(column.values.begin(), column.values.end()),
                              {}});
      else
        attributes.push_back({column.name, column.values, {}});
    }
    return attributes;
  }

 private:
  struct Column {
    std::string name;
    bool is_color = false;
    std::vector<double> values;
  };

  void name_columns(std::string_view words) {
    if (layout_.normals)
      for (const char* name : {"nx", "ny", "nz"}) columns_.push_back({name, false, {}});
    if (!layout_.colors) return;
    for (const char* name : {"red", "green", "blue"}) columns_.push_back({name, true, {}});
    if (count_words(words) > columns_.size() + (layout_.texture ? 2 : 0))
      columns_.push_back({"alpha", true, {}});
  }

  /// Colours are from 0 to 1 or, in many files, whole numbers to 255.
  [[nodiscard]] bool has_byte_colors() const {
    bool beyond_one = false;
    for (const Column& column : columns_)
      for (const double value : column.values) {
        if (!column.is_color) break;
        if (!(value >= 0 && value <= 255 && value == std::floor(value))) return false;
        beyond_one = beyond_one || value > 1;
      }
    return beyond_one;
  }

  Layout layout_;
  std::vector<Column> columns_;
  bool complete_ = true;
};

}  // namespace

PolygonMesh read_off(std::string_view content, const std::string& file) {
  PolygonMesh mesh;  // grows as the file is read: the counts may be wrong
  OffLines lines(content, file, mesh.comments);
  std::string_view counts = lines.next();
  VertexColumns columns(take_magic(counts, file));
  if (count_words(counts) == 0) counts = lines.next_row("lines with counts", 0, 1);
  const auto vertices = lines.number<std::uint64_t>(counts);
  const auto faces = lines.number<std::uint64_t>(counts);

  for (std::uint64_t row = 0; row < vertices; ++row) {
    std::string_view line = lines.next_row("vertices", row, vertices);
    Eigen::Vector3d vertex;
    for (double& coordinate : vertex) coordinate = lines.number<double>(line);
    mesh.vertices.push_back(vertex);
    columns.take(line, lines);
  }
  mesh.vertex_attributes = columns.result();
  for (std::uint64_t row = 0; row < faces; ++row) {
    std::string_view line = lines.next_row("faces", row, faces);
    const auto size = lines.number<std::uint32_t>(line);
    if (size > line.size()) lines.fail("a face of " + std::to_string(size) + " corners ends early");
    for (std::uint32_t corner = 0; corner < size; ++corner)
      mesh.corners.push_back(lines.number<std::int32_t>(line));
    mesh.sizes.push_back(static_cast<int>(size));
  }
  return mesh;
}

}  // namespace palpate::geometry
