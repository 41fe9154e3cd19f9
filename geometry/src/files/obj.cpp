// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "files/file_formats.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>

#include "base/input_file.h"
#include "files/file_unit.h"
#include "files/scalar_type.h"
#include "palpate/error.h"

namespace palpate::geometry {
namespace {

namespace fs = std::filesystem;

/// The current position in a file, for messages.
struct FilePosition {
  const std::string& file;
  std::string_view content;
  std::size_t offset;

  [[noreturn]] void fail(const std::string& reason) const {
    throw FileError(file + ": line " + std::to_string(line_number(content, offset)) + ": " +
                    reason);
  }
};

/// Joins lines that end in a backslash with the next line. Offsets do not change.
std::string join_continued_lines(std::string content) {
  for (const std::string_view end : {"\\\n", "\\\r\n"})
    for (std::size_t at = content.find(end); at != std::string::npos; at = content.find(end, at))
      content.replace(at, end.size(), end.size(), ' ');
  return content;
}

/// The numbers after a keyword, up to a comment, at most `N`.
template <int N>
struct Numbers {
  Eigen::Matrix<double, N, 1> values;
  int count = 0;
};

template <int N>
Numbers<N> parse_numbers(std::string_view words, const char* what, const FilePosition& place) {
  Numbers<N> numbers;
  for (std::string_view word = next_word(words); !word.empty() && numbers.count < N;
       word = next_word(words)) {
    if (word.starts_with('#')) break;
    const std::optional<double> number = parse_number<double>(word);
    if (!number) place.fail(std::string(what) + " needs three numbers, not " + quoted(word));
    numbers.values[numbers.count++] = *number;
  }
  if (numbers.count < 3)
    place.fail(std::string(what) + " needs three numbers, not " + std::to_string(numbers.count));
  return numbers;
}

/// Converts an index counted from 1, or backwards from the end if negative, to one counted from 0.
std::int64_t parse_index(std::string_view word, std::size_t size, const char* what,
                         const FilePosition& place) {
  const auto number = parse_number<std::int64_t>(word);
  const auto count = static_cast<std::int64_t>(size);
  if (!number || *number == 0 || *number < -count || *number > count)
    place.fail(quoted(word) + " is not a " + what + "; " + std::to_string(count) +
               " came before, counted from 1");
  return *number > 0 ? *number - 1 : count + *number;
}

/// Interprets the lines of a file one by one.
class Reader {
 public:
  explicit Reader(const std::string& file) : file_(file) {}

  void take(std::string_view line, const FilePosition& place) {
    const std::size_t comment = line.find_first_not_of(" \t");
    if (comment != std::string_view::npos && line[comment] == '#') {
      line.remove_prefix(comment + 1);
      mesh_.comments.emplace_back(line.substr(line.starts_with(' ') ? 1 : 0));
      return;
    }
    const std::string_view keyword = next_word(line);
    if (keyword == "v") take_vertex(line, place);
    if (keyword == "vn") normals_.push_back(parse_numbers<3>(line, "a normal", place).values);
    if (keyword == "f") take_face(line, place);
  }

  PolygonMesh result() {
    if (mesh_.vertices.empty())
      throw FileError(file_ + ": is not an OBJ file: it has no line \"v x y z\"");
    keep_normals();
    if (colors_.size() == mesh_.vertices.size()) {
      for (std::size_t channel = 0; channel < kColors.size(); ++channel)
        mesh_.vertex_attributes.push_back(column(kColors[channel], colors_, channel));
    }
    return std::move(mesh_);
  }

 private:
  static constexpr std::array<const char*, 3> kNormals{"nx", "ny", "nz"};
  static constexpr std::array<const char*, 3> kColors{"red", "green", "blue"};
  static constexpr std::int64_t kNoNormal = -1, kSeveralNormals = -2;

  /// x y z, or x y z w with a weight that is not used, or x y z and a colour.
  void take_vertex(std::string_view words, const FilePosition& place) {
    const Numbers<6> numbers = parse_numbers<6>(words, "a vertex", place);
    mesh_.vertices.emplace_back(numbers.values.head<3>());
    if (numbers.count == 6) colors_.emplace_back(numbers.values.tail<3>());
  }

  void take_face(std::string_view words, const FilePosition& place) {
    int size = 0;
    for (std::string_view word = next_word(words); !word.empty(); word = next_word(words), ++size) {
      if (word.starts_with('#')) break;
      take_corner(word, place);
    }
    if (size < 3) place.fail("a face needs at least 3 corners, not " + std::to_string(size));
    mesh_.sizes.push_back(size);
  }

  /// `7`, `7/1`, `7/1/3` or `7//3`: vertex, texture coordinate, normal.
  void take_corner(std::string_view word, const FilePosition& place) {
    const std::size_t slash = word.find('/');
    const std::int64_t vertex =
        parse_index(word.substr(0, slash), mesh_.vertices.size(), "vertex", place);
    mesh_.corners.push_back(vertex);
    const std::size_t last = word.find('/', slash + 1);
    if (slash == std::string_view::npos || last == std::string_view::npos) return;
    const std::int64_t normal =
        parse_index(word.substr(last + 1), normals_.size(), "normal", place);
    normal_of_.resize(mesh_.vertices.size(), kNoNormal);
    std::int64_t& known = normal_of_[static_cast<std::size_t>(vertex)];
    if (known == kNoNormal)
      known = normal;
    else if (known == kSeveralNormals || !same_normal(known, normal))
      known = kSeveralNormals;
  }

  [[nodiscard]] bool same_normal(std::int64_t a, std::int64_t b) const {
    return normals_[static_cast<std::size_t>(a)] == normals_[static_cast<std::size_t>(b)];
  }

  /// Normals belong to corners: they are those of vertices iff each vertex has exactly one.
  void keep_normals() {
    normal_of_.resize(mesh_.vertices.size(), kNoNormal);
    // A file of points refers to no normals; they are then in the order of the vertices.
    if (mesh_.corners.empty() && normals_.size() == mesh_.vertices.size())
      std::iota(normal_of_.begin(), normal_of_.end(), 0);
    std::vector<Eigen::Vector3d> of_vertices;
    for (const std::int64_t normal : normal_of_) {
      if (normal < 0) return;
      of_vertices.push_back(normals_[static_cast<std::size_t>(normal)]);
    }
    for (std::size_t axis = 0; axis < kNormals.size(); ++axis)
      mesh_.vertex_attributes.push_back(column(kNormals[axis], of_vertices, axis));
  }

  static Attribute column(const char* name, const std::vector<Eigen::Vector3d>& rows,
                          std::size_t axis) {
    std::vector<double> values;
    values.reserve(rows.size());
    for (const Eigen::Vector3d& row : rows) values.push_back(row[static_cast<Eigen::Index>(axis)]);
    return {name, std::move(values), {}};
  }

  const std::string& file_;
  PolygonMesh mesh_;
  std::vector<Eigen::Vector3d> normals_, colors_;
  std::vector<std::int64_t> normal_of_;  ///< of each vertex
};

}  // namespace

PolygonMesh read_obj(const fs::path& path) {
  const std::string content = read_input_file(path);
  const std::string joined = join_continued_lines(content);
  const std::string file = path.string();
  Reader reader(file);
  std::string_view rest = joined;
  while (!rest.empty()) {
    const FilePosition place{file, content, content.size() - rest.size()};
    reader.take(next_line(rest), place);
  }
  return reader.result();
}

void write_obj(std::ostream& stream, const MeshFile& file) {
  std::string text = "# " + std::string(kUnitComment) + "\n";
  for (const std::string& comment : file.comments) text += "# " + comment + "\n";
  const auto put = [&](const auto& numbers) {
    for (const double number : numbers) {
      text += ' ';
      append_digits(text, number);
    }
  };
  const std::optional<Eigen::Matrix4Xd> color = colors(file.vertex_attributes);
  const std::optional<Eigen::Matrix3Xd> normal = normals(file.vertex_attributes);
  const TriangleMesh& mesh = file.mesh;
  for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i) {
    text += 'v';
    put(mesh.vertices.col(i));
    if (color) put(color->col(i).head<3>());
    text += '\n';
  }
  for (Eigen::Index i = 0; normal && i < normal->cols(); ++i) {
    text += "vn";
    put(normal->col(i));
    text += '\n';
  }
  for (const auto& triangle : mesh.triangles.colwise()) {
    text += 'f';
    for (const int corner : triangle) {
      const std::string number = std::to_string(std::int64_t{corner} + 1);
      text += ' ' + number;
      if (normal) text += "//" + number;
    }
    text += '\n';
  }
  stream.write(text.data(), static_cast<std::streamsize>(text.size()));
}

}  // namespace palpate::geometry
