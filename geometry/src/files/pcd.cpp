// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "files/file_formats.h"

#include <lzf.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "files/pcd_fields.h"
#include "files/scalar_type.h"
#include "palpate/core/error.h"
#include "palpate/core/input_file.h"

namespace palpate::geometry {
namespace {

namespace fs = std::filesystem;

// LZF writes 3 bytes for at most 264 that it repeats.
constexpr std::uint64_t kMaxCompression = 264 / 3;

// Fields of this name are padding; there may be several.
constexpr std::string_view kPadding = "_";

struct Field {
  std::string name;
  Scalar type = Scalar::float32;
  std::uint64_t count = 1;   ///< numbers per point
  std::uint64_t offset = 0;  ///< bytes from the start of a point
};

struct Header {
  std::vector<Field> fields;
  std::uint64_t width = 0;
  std::uint64_t height = 1;
  std::uint64_t points = 0;
  std::uint64_t values = 0;       ///< numbers per point
  std::uint64_t point_bytes = 0;  ///< bytes per point, unless it is text
  std::string_view data;          ///< ascii, binary or binary_compressed
  std::vector<std::string> comments;
  std::size_t size = 0;  ///< bytes of the header
};

std::optional<Scalar> scalar_of(std::string_view kind, std::uint64_t bytes) {
  using enum Scalar;
  static constexpr std::array<Scalar, 10> kAll{int8,   uint8, int16,  uint16,  int32,
                                               uint32, int64, uint64, float32, float64};
  const std::array<std::string_view, 10> kinds{"I", "U", "I", "U", "I", "U", "I", "U", "F", "F"};
  for (std::size_t i = 0; i < kAll.size(); ++i)
    if (kinds[i] == kind && size_of(kAll[i]) == bytes) return kAll[i];
  return std::nullopt;
}

/// The words after each keyword of the header.
struct HeaderLines {
  std::vector<std::string_view> fields, size, type, count, width, height, points, data;

  std::vector<std::string_view>* find(std::string_view keyword) {
    if (keyword == "FIELDS") return &fields;
    if (keyword == "SIZE") return &size;
    if (keyword == "TYPE") return &type;
    if (keyword == "COUNT") return &count;
    if (keyword == "WIDTH") return &width;
    if (keyword == "HEIGHT") return &height;
    if (keyword == "POINTS") return &points;
    if (keyword == "DATA") return &data;
    return nullptr;
  }
};

std::uint64_t whole_number(const std::string& file, const char* keyword, std::string_view word,
                           std::uint64_t greatest) {
  const auto number = parse_number<std::uint64_t>(word);
  if (!number || *number > greatest)
    throw FileError(file + ": " + keyword + " is " + quoted(word) + "; a whole number from 0 to " +
                    std::to_string(greatest) + " is needed");
  return *number;
}

void take_fields(const HeaderLines& lines, const std::string& file, Header& header) {
  constexpr std::uint64_t kMaxCount = std::numeric_limits<std::uint16_t>::max();
  const std::size_t fields = lines.fields.size();
  if (lines.size.size() != fields || lines.type.size() != fields ||
      (!lines.count.empty() && lines.count.size() != fields))
    throw FileError(file +
                    ": FIELDS, SIZE, TYPE and COUNT of the PCD header must have as many words");
  for (std::size_t i = 0; i < fields; ++i) {
    Field field{.name = std::string(lines.fields[i])};
    if (field.name != kPadding &&
        std::count(lines.fields.begin(), lines.fields.end(), lines.fields[i]) != 1)
      throw FileError(file + ": field " + field.name + " appears twice");
    const std::uint64_t bytes = whole_number(file, "SIZE", lines.size[i], 8);
    const std::optional<Scalar> type = scalar_of(lines.type[i], bytes);
    if (!type)
      throw FileError(file + ": field " + field.name + " is of TYPE " + std::string(lines.type[i]) +
                      " and SIZE " + std::to_string(bytes) +
                      "; I and U have 1, 2, 4, 8, F has 4, 8");
    field.type = *type;
    if (!lines.count.empty()) field.count = whole_number(file, "COUNT", lines.count[i], kMaxCount);
    field.offset = header.point_bytes;
    header.point_bytes += bytes * field.count;
    header.values += field.count;
    header.fields.push_back(std::move(field));
  }
}

void take_point_count(const HeaderLines& lines, const std::string& file, Header& header) {
  const auto one = [&](const char* keyword, const std::vector<std::string_view>& words,
                       std::uint64_t otherwise) {
    return words.empty()
               ? otherwise
               : whole_number(file, keyword, words[0], std::numeric_limits<std::uint32_t>::max());
  };
  header.width = one("WIDTH", lines.width, one("POINTS", lines.points, 0));
  header.height = one("HEIGHT", lines.height, 1);
  header.points = one("POINTS", lines.points, header.width * header.height);
  if (header.width * header.height != header.points)
    throw FileError(file + ": POINTS is " + std::to_string(header.points) +
                    ", but WIDTH x HEIGHT is " + std::to_string(header.width) + " x " +
                    std::to_string(header.height));
}

/// Keeps a line if it is a comment, except the first one of every file, which names the format.
void take_comment(std::string_view line, Header& header) {
  if (!line.starts_with('#')) return;
  line.remove_prefix(line.starts_with("# ") ? 2 : 1);
  if (!line.starts_with(".PCD")) header.comments.emplace_back(line);
}

Header parse_header(std::string_view content, const std::string& file) {
  Header header;
  HeaderLines lines;
  std::string_view rest = content;
  while (!rest.empty() && lines.data.empty()) {
    std::string_view line = next_line(rest);
    take_comment(line, header);
    if (std::vector<std::string_view>* words = lines.find(next_word(line)))
      for (std::string_view word = next_word(line); !word.empty(); word = next_word(line))
        words->push_back(word);
  }
  if (lines.fields.empty() || lines.data.empty())
    throw FileError(file + ": is not a PCD file, or it is truncated: no lines FIELDS and DATA");
  header.data = lines.data[0];
  header.size = content.size() - rest.size();
  take_fields(lines, file, header);
  take_point_count(lines, file, header);
  return header;
}

FileError truncated(const std::string& file, std::uint64_t present, std::uint64_t points) {
  return FileError(file + ": holds " + std::to_string(present) + " of " + std::to_string(points) +
                   " points; it is truncated or its header is wrong");
}

/// One empty column per field.
Attributes make_columns(const Header& header, bool text) {
  Attributes columns;
  for (const Field& field : header.fields) {
    // A coordinate in a text may have more digits than its type holds.
    const bool coordinate = field.name == "x" || field.name == "y" || field.name == "z";
    columns.push_back(
        {field.name, no_values(text && coordinate ? Scalar::float64 : field.type), {}});
    if (field.count != 1)
      columns.back().list_sizes.assign(header.points, static_cast<int>(field.count));
    std::visit([&](auto& numbers) { numbers.reserve(header.points * field.count); },
               columns.back().values);
  }
  return columns;
}

Attributes read_text(std::string_view body, const Header& header, const std::string& file) {
  // A number takes at least a digit and a blank, except that the last blank may be missing.
  if (header.points > (body.size() + 1) / (2 * header.values))
    throw truncated(file, (body.size() + 1) / (2 * header.values), header.points);
  Attributes columns = make_columns(header, true);
  for (std::uint64_t point = 0; point < header.points; ++point)
    for (std::size_t i = 0; i < columns.size(); ++i)
      for (std::uint64_t k = 0; k < header.fields[i].count; ++k) {
        const std::string_view word = next_word(body);
        if (word.empty()) throw truncated(file, point, header.points);
        if (columns[i].name != kPadding && !append_parsed(columns[i].values, word))
          throw FileError(file + ": point " + std::to_string(point) + ", field " + columns[i].name +
                          ": " + quoted(word) + " is not a number of its type");
      }
  return columns;
}

/// The data are stored point by point, or field by field if `by_field`.
Attributes unpack(std::string_view body, const Header& header, bool by_field) {
  Attributes columns = make_columns(header, false);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const Field& field = header.fields[i];
    if (field.name == kPadding) continue;
    const std::uint64_t first = by_field ? field.offset * header.points : field.offset;
    const std::uint64_t bytes = size_of(field.type);
    const std::uint64_t step = by_field ? bytes * field.count : header.point_bytes;
    if (field.count == 1) {
      append_loaded(columns[i].values, std::endian::little, body.data() + first, header.points,
                    step);
      continue;
    }
    for (std::uint64_t point = 0; point < header.points; ++point)
      append_loaded(columns[i].values, std::endian::little, body.data() + first + point * step,
                    field.count, bytes);
  }
  return columns;
}

Attributes read_compressed(std::string_view body, const Header& header, const std::string& file) {
  constexpr std::size_t kSizes = 8;  // two uint32 in front: bytes compressed and uncompressed
  if (body.size() < kSizes) throw truncated(file, 0, header.points);
  const auto size_at = [&](std::size_t offset) {
    return std::uint64_t{load<std::uint32_t>(std::endian::little, body.data() + offset)};
  };
  const std::uint64_t compressed = size_at(0);
  const std::uint64_t size = size_at(4);
  if (size / header.point_bytes != header.points || size % header.point_bytes != 0)
    throw FileError(file + ": its compressed part holds " + std::to_string(size) + " bytes, but " +
                    std::to_string(header.points) + " points of " +
                    std::to_string(header.point_bytes) + " bytes were announced");
  if (compressed > body.size() - kSizes)
    throw FileError(file + ": holds " + std::to_string(body.size() - kSizes) + " of " +
                    std::to_string(compressed) + " compressed bytes; it is truncated");
  if (size > compressed * kMaxCompression)
    throw FileError(file + ": " + std::to_string(compressed) + " compressed bytes cannot hold " +
                    std::to_string(size) + "; the file is damaged");
  // Bytes, columns and coordinates in double.
  check_memory_to_read(
      3 * static_cast<double>(size) + 3 * sizeof(double) * static_cast<double>(header.points),
      static_cast<double>(body.size()), file);
  std::string points(size, '\0');
  if (lzf_decompress(body.data() + kSizes, static_cast<unsigned>(compressed), points.data(),
                     static_cast<unsigned>(size)) != size)
    throw FileError(file + ": its compressed part is damaged");
  return unpack(points, header, true);
}

Attributes read_columns(std::string_view body, const Header& header, const std::string& file) {
  if (header.data == "ascii") return read_text(body, header, file);
  if (header.data == "binary_compressed") return read_compressed(body, header, file);
  if (header.data != "binary")
    throw FileError(file + ": DATA is " + quoted(header.data) +
                    "; ascii, binary or binary_compressed is needed");
  if (header.points > body.size() / header.point_bytes)
    throw truncated(file, body.size() / header.point_bytes, header.points);
  return unpack(body, header, false);
}

void check_coordinates(const Header& header, const std::string& file) {
  for (const char* name : {"x", "y", "z"})
    if (std::none_of(header.fields.begin(), header.fields.end(),
                     [&](const Field& field) { return field.name == name && field.count == 1; }))
      throw FileError(file + ": has no field " + name + " of COUNT 1");
}

}  // namespace

PointCloud read_pcd(std::string_view content, const std::string& file) {
  Header header = parse_header(content, file);
  check_coordinates(header, file);
  if (header.points == 0) throw FileError(file + ": holds no points");
  Attributes columns = read_columns(std::string_view(content).substr(header.size), header, file);
  PointCloud cloud;
  cloud.points.resize(3, static_cast<Eigen::Index>(header.points));
  cloud.width = static_cast<Eigen::Index>(header.width);
  cloud.height = static_cast<Eigen::Index>(header.height);
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    cloud.points.row(axis) = scalars(columns, std::string(1, "xyz"[axis]))->transpose();
  std::erase_if(columns, [](const Attribute& column) {
    return column.name == kPadding || column.name == "x" || column.name == "y" ||
           column.name == "z";
  });
  cloud.attributes = from_pcd_fields(std::move(columns));
  cloud.comments = std::move(header.comments);
  return cloud;
}

}  // namespace palpate::geometry
