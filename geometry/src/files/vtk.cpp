// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <cstdint>
#include <ostream>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "files/file_formats.h"

namespace palpate::geometry {
namespace {

// Binary VTK files are big-endian.
template <typename T>
void put(std::ostream& stream, T value) {
  char bytes[sizeof(T)];
  std::copy_n(reinterpret_cast<const char*>(&value), sizeof(T), bytes);
  if constexpr (std::endian::native == std::endian::little) std::reverse(bytes, bytes + sizeof(T));
  stream.write(bytes, sizeof(T));
}

template <typename T>
const char* type_name() {
  if constexpr (std::is_same_v<T, std::int8_t>) return "char";
  if constexpr (std::is_same_v<T, std::uint8_t>) return "unsigned_char";
  if constexpr (std::is_same_v<T, std::int16_t>) return "short";
  if constexpr (std::is_same_v<T, std::uint16_t>) return "unsigned_short";
  if constexpr (std::is_same_v<T, std::int32_t>) return "int";
  if constexpr (std::is_same_v<T, std::uint32_t>) return "unsigned_int";
  if constexpr (std::is_same_v<T, std::int64_t>) return "vtktypeint64";
  if constexpr (std::is_same_v<T, std::uint64_t>) return "vtktypeuint64";
  return std::is_same_v<T, float> ? "float" : "double";
}

void put_attributes(std::ostream& stream, const char* of, Eigen::Index elements,
                    const Attributes& attributes) {
  std::vector<const Attribute*> numbers;  // lists have no place in this format
  for (const Attribute& attribute : attributes)
    if (attribute.list_sizes.empty()) numbers.push_back(&attribute);
  if (numbers.empty()) return;
  stream << of << ' ' << elements << "\nFIELD attributes " << numbers.size() << '\n';
  for (const Attribute* attribute : numbers) {
    std::visit(
        [&]<typename T>(const std::vector<T>& values) {
          stream << attribute->name << " 1 " << values.size() << ' ' << type_name<T>() << '\n';
          for (const T value : values) put(stream, value);
        },
        attribute->values);
    stream << '\n';
  }
}

}  // namespace

void write_vtk(std::ostream& stream, const MeshFile& file) {
  const Eigen::Matrix3Xd& vertices = file.mesh.vertices;
  const Eigen::Matrix3Xi& triangles = file.mesh.triangles;
  stream << "# vtk DataFile Version 3.0\nunit mm\nBINARY\nDATASET POLYDATA\nPOINTS "
         << vertices.cols() << " double\n";
  for (const double coordinate : vertices.reshaped()) put(stream, coordinate);
  stream << "\nPOLYGONS " << triangles.cols() << ' ' << 4 * triangles.cols() << '\n';
  for (const auto& corners : triangles.colwise()) {
    put(stream, std::int32_t{3});
    for (const int corner : corners) put(stream, std::int32_t{corner});
  }
  stream << '\n';
  put_attributes(stream, "POINT_DATA", vertices.cols(), file.vertex_attributes);
  put_attributes(stream, "CELL_DATA", triangles.cols(), file.triangle_attributes);
}

}  // namespace palpate::geometry
