// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "file_testing.h"
#include "palpate/core/error.h"
#include "palpate/geometry/mesh_io.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

std::string stl_text() {
  std::ostringstream text;
  text << std::fixed << "solid tetrahedron\n";
  for (const Eigen::Vector3i& face : kTetrahedronFaces) {
    text << " facet normal 0 0 0\n  outer loop\n";
    for (const int corner : face)
      text << "   vertex " << kTetrahedronCorners[static_cast<std::size_t>(corner)].transpose()
           << "\n";
    text << "  endloop\n endfacet\n";
  }
  text << "endsolid tetrahedron\n";
  return text.str();
}

std::string stl_binary() {
  std::string bytes(80, ' ');
  const auto put = [&](auto value) {
    const auto raw = std::bit_cast<std::array<char, sizeof(value)>>(value);
    bytes.append(raw.data(), raw.size());
  };
  put(static_cast<std::uint32_t>(kTetrahedronFaces.size()));
  for (const Eigen::Vector3i& face : kTetrahedronFaces) {
    for (int i = 0; i < 3; ++i) put(0.0F);
    for (const int corner : face)
      for (const double x : kTetrahedronCorners[static_cast<std::size_t>(corner)])
        put(static_cast<float>(x));
    put(std::uint16_t{0});
  }
  return bytes;
}

MeshFile read_stl(const std::string& content) {
  const ScratchFolder folder;
  write_text(folder / "mesh.stl", content);
  return read_mesh_file(folder / "mesh.stl");
}

void expect_stl_refused(const std::string& content, const std::string& words) {
  EXPECT_THROWS_MESSAGE(static_cast<void>(read_stl(content)), FileError, words);
}

TEST(Stl, CornersAtOnePlaceBecomeOneVertex) {
  for (const std::string& content : {stl_text(), stl_binary()}) {
    const TriangleMesh mesh = read_stl(content).mesh;
    ASSERT_EQ(mesh.vertices.cols(), 4);
    ASSERT_EQ(mesh.triangles.cols(), 4);
    for (Eigen::Index face = 0; face < 4; ++face)
      for (Eigen::Index corner = 0; corner < 3; ++corner)
        EXPECT_EQ(mesh.vertices.col(mesh.triangles(corner, face)),
                  kTetrahedronCorners[static_cast<std::size_t>(
                      kTetrahedronFaces[static_cast<std::size_t>(face)][corner])]);
  }
}

TEST(Stl, NearCornersStayApartAndTheTwoZerosAreOnePlace) {
  EXPECT_EQ(read_stl(replaced(stl_text(), "0.000000", "0.000001")).mesh.vertices.cols(), 5);
  EXPECT_EQ(read_stl(replaced(stl_text(), "0.000000", "-0.000000")).mesh.vertices.cols(), 4);
}

TEST(Stl, ABinaryFileMayStartLikeAText) {
  std::string binary = stl_binary();
  binary.replace(0, 16, "solid unit cube ");
  EXPECT_EQ(read_stl(binary).mesh.triangles.cols(), 4);
}

TEST(Stl, ATextMayHoldSeveralSolidsAndNormalsThatAreNoNumbers) {
  const std::string text = replaced(stl_text(), "normal 0 0 0", "normal -nan(ind) 0 0");
  EXPECT_EQ(read_stl(text + text).mesh.triangles.cols(), 8);
}

TEST(Stl, FloatsComeBackFromBinaryAndDoublesFromText) {
  const ScratchFolder folder;
  TriangleMesh mesh = test::icosphere(2, 100.1);
  write_mesh(folder / "text.stl", mesh, {.encoding = Encoding::text});
  const TriangleMesh text = read_mesh(folder / "text.stl");
  mesh.vertices = mesh.vertices.cast<float>().cast<double>();
  mesh.vertices(0, 0) = double{std::numeric_limits<float>::denorm_min()};
  mesh.vertices(1, 1) = -double{std::numeric_limits<float>::max()};
  write_mesh(folder / "binary.stl", mesh);
  const TriangleMesh binary = read_mesh(folder / "binary.stl");
  ASSERT_EQ(binary.vertices.cols(), mesh.vertices.cols());
  const TriangleMesh doubles = test::icosphere(2, 100.1);
  // Vertices are in the order in which triangles name them.
  for (Eigen::Index i = 0; i < mesh.triangles.cols(); ++i)
    for (Eigen::Index corner = 0; corner < 3; ++corner) {
      EXPECT_EQ(binary.vertices.col(binary.triangles(corner, i)),
                mesh.vertices.col(mesh.triangles(corner, i)));
      EXPECT_EQ(text.vertices.col(text.triangles(corner, i)),
                doubles.vertices.col(doubles.triangles(corner, i)));
    }
}

TEST(Stl, WritesTheNormalsOfTheTriangles) {
  const ScratchFolder folder;
  TriangleMesh mesh;
  mesh.vertices.resize(3, 4);
  mesh.vertices << 0, 3, 0, 6, 0, 0, 2, 0, 0, 0, 0, 0;
  mesh.triangles.resize(3, 2);
  mesh.triangles << 0, 0, 1, 1, 2, 3;  // the second has no area
  write_mesh(folder / "mesh.stl", mesh, {.encoding = Encoding::text});
  EXPECT_EQ(read_text(folder / "mesh.stl"),
            "solid unit mm\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 3 0 0\n"
            "   vertex 0 2 0\n  endloop\n endfacet\n facet normal 0 0 0\n  outer loop\n"
            "   vertex 0 0 0\n   vertex 3 0 0\n   vertex 6 0 0\n  endloop\n endfacet\nendsolid\n");
  write_mesh(folder / "mesh.stl", mesh);
  const std::string bytes = read_text(folder / "mesh.stl");
  ASSERT_EQ(bytes.size(), 84U + 2 * 50);
  std::array<char, 4> z_of_normal;
  std::copy_n(bytes.begin() + 84 + 8, 4, z_of_normal.begin());
  EXPECT_EQ(std::bit_cast<float>(z_of_normal), 1.0F);
}

TEST(Stl, RefusesWithThePlace) {
  const std::string binary = stl_binary();
  expect_stl_refused(binary.substr(0, binary.size() - 60),
                     "holds 2 of 4 triangles; it is truncated");
  expect_stl_refused(binary.substr(0, 83), "is not an STL file, or it is truncated");
  expect_stl_refused(replaced(stl_text(), "endsolid", ""), "where facet or endsolid is needed");
  expect_stl_refused(replaced(stl_text(), "endloop", "vertex 1 2 3\nendloop"),
                     "line 7: \"vertex\" where endloop is needed");
  expect_stl_refused(replaced(stl_text(), "0.000000", "zero"), "line 4: \"zero\" where a number");
  expect_stl_refused(replaced(stl_text(), "0.000000", "nan"),
                     "vertex 0 (counted from 0) is not finite");
  expect_stl_refused("solid empty\nendsolid empty\n", "holds no vertices");
  std::string huge = binary;
  huge.replace(80, 4, "\xff\xff\xff\xff");
  expect_stl_refused(huge, "holds 4 of 4294967295 triangles");
}

TEST(Stl, RefusesToRoundWhatIsBeyondFloat) {
  const ScratchFolder folder;
  TriangleMesh mesh = test::icosphere(0, 1);
  mesh.vertices(1, 7) = -1e39;
  EXPECT_THROWS_MESSAGE(write_mesh(folder / "mesh.stl", mesh), InvalidInput,
                        "vertex 7 is beyond the range of float");
  EXPECT_THROWS_MESSAGE(
      write_mesh(folder / "mesh.stl", mesh, {.encoding = Encoding::binary_big_endian}),
      InvalidInput, "only PLY supports big-endian binary");
  write_mesh(folder / "mesh.stl", mesh, {.encoding = Encoding::text});
  EXPECT_EQ(read_mesh(folder / "mesh.stl").vertices.minCoeff(), -1e39);
}

}  // namespace
}  // namespace palpate::geometry
