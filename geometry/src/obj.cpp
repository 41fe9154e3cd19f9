// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "obj.h"

#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>

#include "input_file.h"
#include "palpate/error.h"

namespace palpate::geometry {
namespace {

namespace fs = std::filesystem;

/// Where we are in a file, for messages.
struct Place {
  const std::string& file;
  std::string_view content;
  std::size_t offset;

  [[noreturn]] void fail(const std::string& reason) const {
    throw FileError(file + ": line " + std::to_string(line_number(content, offset)) + ": " +
                    reason);
  }
};

/// A backslash at the end of a line joins it with the next. Every offset stays what it was.
std::string join_continued_lines(std::string content) {
  for (const std::string_view end : {"\\\n", "\\\r\n"})
    for (std::size_t at = content.find(end); at != std::string::npos; at = content.find(end, at))
      content.replace(at, end.size(), end.size(), ' ');
  return content;
}

Eigen::Vector3d parse_vertex(std::string_view words, const Place& place) {
  Eigen::Vector3d vertex;
  for (double& coordinate : vertex) {
    const std::string_view word = next_word(words);
    const std::optional<double> number = parse_number<double>(word);
    if (!number) place.fail("a vertex needs three numbers, not " + quoted(word));
    coordinate = *number;
  }
  return vertex;
}

/// `7`, `7/1`, `7/1/3` or `7//3`, counted from 1, or back from the last vertex if negative.
std::int64_t parse_corner(std::string_view word, std::size_t vertices, const Place& place) {
  const auto number = parse_number<std::int64_t>(word.substr(0, word.find('/')));
  const auto count = static_cast<std::int64_t>(vertices);
  if (!number || *number == 0 || *number < -count || *number > count)
    place.fail(quoted(word) + " is not a vertex; " + std::to_string(count) +
               " came before, counted from 1");
  return *number > 0 ? *number - 1 : count + *number;
}

void append_number(std::string& text, double number) {
  std::array<char, 32> digits;  // the longest double takes 24
  const auto [end, error] = std::to_chars(digits.begin(), digits.end(), number);
  text.append(digits.begin(), end);
}

}  // namespace

PolygonMesh read_obj(const fs::path& path) {
  const std::string content = read_input_file(path);
  const std::string joined = join_continued_lines(content);
  const std::string file = path.string();
  PolygonMesh mesh;
  std::string_view rest = joined;
  while (!rest.empty()) {
    const Place place{file, content, content.size() - rest.size()};
    std::string_view line = next_line(rest);
    const std::string_view keyword = next_word(line);
    if (keyword == "v") mesh.vertices.push_back(parse_vertex(line, place));
    if (keyword != "f") continue;
    int size = 0;
    for (std::string_view word = next_word(line); !word.empty(); word = next_word(line), ++size) {
      if (word.starts_with('#')) break;
      mesh.corners.push_back(parse_corner(word, mesh.vertices.size(), place));
    }
    if (size < 3) place.fail("a face needs at least 3 corners, not " + std::to_string(size));
    mesh.sizes.push_back(size);
  }
  if (mesh.vertices.empty())
    throw FileError(file + ": is not an OBJ file: it has no line \"v x y z\"");
  return mesh;
}

void write_obj(std::ostream& stream, const TriangleMesh& mesh) {
  std::string text;
  for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i) {
    text += 'v';
    for (int axis = 0; axis < 3; ++axis) {
      text += ' ';
      append_number(text, mesh.vertices(axis, i));
    }
    text += '\n';
  }
  for (Eigen::Index i = 0; i < mesh.triangles.cols(); ++i) {
    text += 'f';
    for (int corner = 0; corner < 3; ++corner)
      text += ' ' + std::to_string(std::int64_t{mesh.triangles(corner, i)} + 1);
    text += '\n';
  }
  stream.write(text.data(), static_cast<std::streamsize>(text.size()));
}

}  // namespace palpate::geometry
