// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <string>

#include "file_testing.h"
#include "palpate/geometry/mesh_io.h"

namespace palpate::geometry {
namespace {

// Byte by byte according to VTK's description of its file formats; in tests/python VTK reads one.
TEST(Vtk, HasPointsPolygonsAndFieldsInBigEndianNumbers) {
  const ScratchFolder folder;
  MeshFile file;
  file.mesh.vertices = Eigen::Matrix3d{{0, 1, 0}, {0, 0, 2.5}, {7, 7, 7}};
  file.mesh.triangles = Eigen::Vector3i(0, 1, 2);
  file.vertex_attributes = {
      {.name = "deviation", .values = std::vector<float>{0.5F, 1, -2}, .list_sizes = {}}};
  file.triangle_attributes = {
      {.name = "part", .values = std::vector<std::int16_t>{300}, .list_sizes = {}}};
  write_mesh_file(folder / "one.vtk", file);
  std::string expected =
      "# vtk DataFile Version 3.0\nunit mm\nBINARY\nDATASET POLYDATA\nPOINTS 3 double\n";
  for (const double number : {0.0, 0.0, 7.0, 1.0, 0.0, 7.0, 0.0, 2.5, 7.0})
    put(expected, number, std::endian::big);
  expected += "\nPOLYGONS 1 4\n";
  for (const std::int32_t number : {3, 0, 1, 2}) put(expected, number, std::endian::big);
  expected += "\nPOINT_DATA 3\nFIELD attributes 1\ndeviation 1 3 float\n";
  for (const float number : {0.5F, 1.0F, -2.0F}) put(expected, number, std::endian::big);
  expected += "\nCELL_DATA 1\nFIELD attributes 1\npart 1 1 short\n";
  put(expected, std::int16_t{300}, std::endian::big);
  EXPECT_EQ(read_text(folder / "one.vtk"), expected + "\n");
}

}  // namespace
}  // namespace palpate::geometry
