// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "files/file_formats.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>

#include "files/file_unit.h"
#include "files/scalar_type.h"
#include "palpate/core/error.h"
#include "palpate/core/input_file.h"

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

std::string needs(const char* what, int numbers) {
  return std::string(what) +
         (numbers == 1 ? " needs a number, not " : " needs three numbers, not ");
}

/// \param least numbers that there must be.
template <int N>
Numbers<N> parse_numbers(std::string_view words, const char* what, const FilePosition& place,
                         int least = 3) {
  Numbers<N> numbers;
  for (std::string_view word = next_word(words); !word.empty() && numbers.count < N;
       word = next_word(words)) {
    if (word.starts_with('#')) break;
    const std::optional<double> number = parse_number<double>(word);
    if (!number) place.fail(needs(what, least) + quoted(word));
    numbers.values[numbers.count++] = *number;
  }
  if (numbers.count < least) place.fail(needs(what, least) + std::to_string(numbers.count));
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
    if (keyword == "vt") take_texture(line, place);
    if (keyword == "f") take_face(line, place);
    if (keyword == "mtllib") mesh_.material_files.emplace_back(rest_of_line(line));
    if (keyword == "usemtl") take_material(std::string(rest_of_line(line)));
  }

  PolygonMesh result() {
    if (mesh_.vertices.empty())
      throw FileError(file_ + ": is not an OBJ file: it has no line \"v x y z\"");
    keep_normals();
    keep_texture();
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
  static constexpr std::int64_t kNoTexture = -1;

  static std::string_view rest_of_line(std::string_view line) {
    const std::size_t begin = line.find_first_not_of(" \t");
    const std::size_t end = line.find_last_not_of(" \t\r");
    return begin == std::string_view::npos ? "" : line.substr(begin, end - begin + 1);
  }

  /// u v, or u v w with a depth that is not used; one number is a place in a strip.
  void take_texture(std::string_view words, const FilePosition& place) {
    const Numbers<3> numbers = parse_numbers<3>(words, "a texture coordinate", place, 1);
    texture_.emplace_back(numbers.values[0], numbers.count > 1 ? numbers.values[1] : 0);
  }

  void take_material(const std::string& name) {
    const auto known = std::ranges::find(mesh_.materials, name);
    material_ = static_cast<std::int32_t>(known - mesh_.materials.begin());
    if (known == mesh_.materials.end()) mesh_.materials.push_back(name);
  }

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
    material_of_.push_back(material_);
  }

  /// `7`, `7/1`, `7/1/3` or `7//3`: vertex, texture coordinate, normal.
  void take_corner(std::string_view word, const FilePosition& place) {
    const std::size_t slash = word.find('/');
    const std::int64_t vertex =
        parse_index(word.substr(0, slash), mesh_.vertices.size(), "vertex", place);
    mesh_.corners.push_back(vertex);
    const std::size_t last = word.find('/', slash + 1);
    // Some programs refer to coordinates that they do not write.
    if (slash != std::string_view::npos && last != slash + 1 && !texture_.empty()) {
      texture_of_.resize(mesh_.corners.size() - 1, kNoTexture);
      texture_of_.push_back(parse_index(word.substr(slash + 1, last - slash - 1), texture_.size(),
                                        "texture coordinate", place));
    }
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

  /// As in PLY files: a list of u and v of each corner for each face that has all of them.
  void keep_texture() {
    if (!mesh_.materials.empty())
      mesh_.face_attributes.push_back({"texnumber", std::move(material_of_), {}});
    if (texture_of_.empty()) return;
    texture_of_.resize(mesh_.corners.size(), kNoTexture);
    std::vector<double> numbers;
    std::vector<int> sizes;
    auto corner = texture_of_.begin();
    for (const int size : mesh_.sizes) {
      const auto end = corner + size;
      const bool is_known = std::find(corner, end, kNoTexture) == end;
      sizes.push_back(is_known ? 2 * size : 0);
      for (; corner != end; ++corner) {
        if (!is_known) continue;
        const Eigen::Vector2d& at = texture_[static_cast<std::size_t>(*corner)];
        numbers.insert(numbers.end(), at.begin(), at.end());
      }
    }
    mesh_.face_attributes.push_back({"texcoord", std::move(numbers), std::move(sizes)});
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
  std::vector<Eigen::Vector2d> texture_;
  std::vector<std::int64_t> texture_of_;   ///< of the corners so far; without those at the end
  std::vector<std::int32_t> material_of_;  ///< of each face
  std::int32_t material_ = -1;
};

}  // namespace

PolygonMesh read_obj(std::string_view content, const std::string& file) {
  const std::string joined = join_continued_lines(std::string(content));
  Reader reader(file);
  std::string_view rest = joined;
  while (!rest.empty()) {
    const FilePosition place{file, content, content.size() - rest.size()};
    reader.take(next_line(rest), place);
  }
  return reader.result();
}

}  // namespace palpate::geometry
