// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "files/file_formats.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>

#include "files/file_unit.h"
#include "files/scalar_type.h"
#include "palpate/core/error.h"
#include "palpate/core/input_file.h"

namespace palpate::geometry {
namespace {

namespace fs = std::filesystem;

// Binary: a header of any text, a count, and for each triangle its normal, corners and two bytes.
constexpr std::size_t kHeaderBytes = 80;
constexpr std::size_t kCountBytes = 4;
constexpr std::size_t kVectorBytes = 12;
constexpr std::size_t kTriangleBytes = 4 * kVectorBytes + 2;

void append_corner(const Eigen::Vector3d& corner, PolygonMesh& mesh) {
  mesh.corners.push_back(static_cast<std::int64_t>(mesh.vertices.size()));
  mesh.vertices.push_back(corner);
}

std::uint64_t announced_bytes(std::string_view content) {
  if (content.size() < kHeaderBytes + kCountBytes) return 0;
  return kHeaderBytes + kCountBytes +
         std::uint64_t{load<std::uint32_t>(std::endian::little, content.data() + kHeaderBytes)} *
             kTriangleBytes;
}

PolygonMesh read_binary(std::string_view content, const std::string& file) {
  const std::uint64_t announced = announced_bytes(content);
  if (announced == 0)
    throw FileError(
        file + ": is not an STL file, or it is truncated: a binary one has a header of " +
        std::to_string(kHeaderBytes + kCountBytes) + " bytes, a text starts with solid");
  const char* bytes = content.data() + kHeaderBytes + kCountBytes;
  if (announced > content.size())
    throw FileError(file + ": holds " +
                    std::to_string((content.size() - kHeaderBytes - kCountBytes) / kTriangleBytes) +
                    " of " +
                    std::to_string((announced - kHeaderBytes - kCountBytes) / kTriangleBytes) +
                    " triangles; it is truncated, or not an STL file");
  PolygonMesh mesh;
  const std::size_t triangles = (announced - kHeaderBytes - kCountBytes) / kTriangleBytes;
  mesh.vertices.reserve(3 * triangles);
  mesh.corners.reserve(3 * triangles);
  mesh.sizes.reserve(triangles);
  for (const char* end = content.data() + announced; bytes < end; bytes += kTriangleBytes) {
    for (std::size_t corner = 1; corner <= 3; ++corner) {
      Eigen::Vector3d place;
      for (Eigen::Index axis = 0; axis < 3; ++axis)
        place[axis] = static_cast<double>(load<float>(
            std::endian::little,
            bytes + corner * kVectorBytes + static_cast<std::size_t>(axis) * sizeof(float)));
      append_corner(place, mesh);
    }
    mesh.sizes.push_back(3);
  }
  mesh.unit = declared_unit(content.substr(0, std::min(kHeaderBytes, content.find('\0'))));
  return mesh;
}

/// The words of a text STL.
class Words {
 public:
  Words(std::string_view content, const std::string& file)
      : content_(content), rest_(content), file_(file) {}

  /// The next word; empty at the end of the file.
  std::string_view next() { return word_ = next_word(rest_); }

  std::string_view rest_of_line() { return next_line(rest_); }

  double next_number() {
    const std::optional<double> number = parse_number<double>(next());
    if (!number) fail("a number");
    return *number;
  }

  void expect(std::string_view word) {
    if (next() != word) fail(std::string(word));
  }

  [[noreturn]] void fail(const std::string& wanted) const {
    throw FileError(file_ + ": line " +
                    std::to_string(line_number(content_, content_.size() - rest_.size())) + ": " +
                    (word_.empty() ? std::string("the file ends") : quoted(word_)) + " where " +
                    wanted + " is needed");
  }

 private:
  std::string_view content_;
  std::string_view rest_;
  std::string_view word_;
  const std::string& file_;
};

void read_facet(Words& words, PolygonMesh& mesh) {
  words.expect("normal");
  // Some writers write a normal without length as nan, or in other words. It is not used.
  for (int axis = 0; axis < 3; ++axis)
    if (words.next().empty()) words.fail("a normal");
  words.expect("outer");
  words.expect("loop");
  for (int corner = 0; corner < 3; ++corner) {
    words.expect("vertex");
    Eigen::Vector3d place;
    for (double& coordinate : place) coordinate = words.next_number();
    append_corner(place, mesh);
  }
  words.expect("endloop");
  words.expect("endfacet");
  mesh.sizes.push_back(3);
}

PolygonMesh read_text(std::string_view content, const std::string& file) {
  PolygonMesh mesh;
  Words words(content, file);
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    if (word != "solid") words.fail("solid");
    const std::optional<double> unit = declared_unit(words.rest_of_line());
    if (!mesh.unit) mesh.unit = unit;
    for (word = words.next(); word == "facet"; word = words.next()) read_facet(words, mesh);
    if (word != "endsolid") words.fail("facet or endsolid");
    static_cast<void>(words.rest_of_line());
  }
  return mesh;
}

/// The normal of a triangle and its three corners.
std::array<Eigen::Vector3d, 4> facet(const TriangleMesh& mesh, const Eigen::Matrix3Xd& normals,
                                     Eigen::Index triangle) {
  std::array<Eigen::Vector3d, 4> vectors;
  vectors[0] = normals.col(triangle);
  if (!vectors[0].allFinite()) vectors[0].setZero();
  for (Eigen::Index corner = 0; corner < 3; ++corner)
    vectors[static_cast<std::size_t>(corner) + 1] =
        mesh.vertices.col(mesh.triangles(corner, triangle));
  return vectors;
}

std::string binary(const TriangleMesh& mesh, const Eigen::Matrix3Xd& normals) {
  std::string bytes(kUnitComment);
  bytes.resize(kHeaderBytes, ' ');
  append_bytes(bytes, std::endian::little, static_cast<std::uint32_t>(mesh.triangles.cols()));
  for (Eigen::Index i = 0; i < mesh.triangles.cols(); ++i) {
    for (const Eigen::Vector3d& vector : facet(mesh, normals, i))
      for (const double x : vector) append_bytes(bytes, std::endian::little, static_cast<float>(x));
    append_bytes(bytes, std::endian::little, std::uint16_t{0});
  }
  return bytes;
}

std::string text(const TriangleMesh& mesh, const Eigen::Matrix3Xd& normals) {
  std::string words = "solid " + std::string(kUnitComment) + "\n";
  for (Eigen::Index i = 0; i < mesh.triangles.cols(); ++i) {
    const std::array<Eigen::Vector3d, 4> vectors = facet(mesh, normals, i);
    for (std::size_t k = 0; k < vectors.size(); ++k) {
      words += k == 0 ? " facet normal" : "   vertex";
      for (const double x : vectors[k]) {
        words += ' ';
        append_digits(words, x);
      }
      words += k == 0 ? "\n  outer loop\n" : "\n";
    }
    words += "  endloop\n endfacet\n";
  }
  return words + "endsolid\n";
}

}  // namespace

bool is_binary_stl(std::string_view content) {
  const std::uint64_t announced = announced_bytes(content);
  return announced > 0 && announced == content.size();
}

PolygonMesh read_stl(std::string_view content, const std::string& file) {
  std::string_view rest = content;
  const bool is_text = !is_binary_stl(content) && next_word(rest) == "solid";
  PolygonMesh mesh = is_text ? read_text(content, file) : read_binary(content, file);
  join_corners(mesh);
  return mesh;
}

void write_stl(std::ostream& stream, const TriangleMesh& mesh, Encoding encoding) {
  const Eigen::Matrix3Xd normals = triangle_normals(mesh);
  const std::string content =
      encoding == Encoding::text ? text(mesh, normals) : binary(mesh, normals);
  stream.write(content.data(), static_cast<std::streamsize>(content.size()));
}

}  // namespace palpate::geometry
