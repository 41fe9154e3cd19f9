// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "file_testing.h"
#include "palpate/core/error.h"
#include "palpate/geometry/mesh_io.h"
#include "repository.h"

namespace palpate::geometry {
namespace {

namespace fs = std::filesystem;

/// Three vertices and one triangle in the middle of all other content that a PLY file may have.
std::string rich_binary(std::endian order) {
  std::string bytes =
      std::string("ply\r\nformat binary_") + (order == std::endian::big ? "big" : "little") +
      "_endian 1.0\r\ncomment made by a test\r\nobj_info none\r\n"
      "element material 2\r\nproperty uchar red\r\nproperty list uchar double weights\r\n"
      "element vertex 3\r\nproperty uchar quality\r\nproperty float64 z\r\n"
      "property short x\r\nproperty list ushort int8 tags\r\nproperty float32 y\r\n"
      "element face 1\r\nproperty float area\r\nproperty list uint ushort vertex_index\r\n"
      "end_header\r\n";
  for (int i = 0; i < 2; ++i) {
    put<std::uint8_t>(bytes, 200, order);
    put<std::uint8_t>(bytes, static_cast<std::uint8_t>(i), order);
    for (int k = 0; k < i; ++k) put<double>(bytes, 0.5, order);
  }
  for (std::int16_t i = 0; i < 3; ++i) {
    put<std::uint8_t>(bytes, 7, order);
    put<double>(bytes, 0.1 + i, order);
    put<std::int16_t>(bytes, static_cast<std::int16_t>(-300 * i), order);
    put<std::uint16_t>(bytes, 2, order);
    put<std::int8_t>(bytes, 1, order);
    put<std::int8_t>(bytes, 1, order);
    put<float>(bytes, 0.7F, order);
  }
  put<float>(bytes, 3, order);
  put<std::uint32_t>(bytes, 3, order);
  for (const int index : {2, 0, 1}) put(bytes, static_cast<std::uint16_t>(index), order);
  return bytes;
}

const std::string kTextVertices =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
    "z\n";
const std::string kSquare = kTextVertices +
                            "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                            "0 0 0.1\n1 0 0.1\n1 1 0.1\n0 1 0.1\n4 0 1 2 3\n";

void expect_ply_refused(const std::string& content, const std::string& words) {
  const ScratchFolder folder;
  write_text(folder / "mesh.ply", content);
  EXPECT_THROWS_MESSAGE(static_cast<void>(read_mesh(folder / "mesh.ply")), FileError, words);
}

TEST(Ply, ReadsTheBundledSheet) {
  const TriangleMesh mesh = read_mesh(repository("demo/sheet/surface.ply"));
  EXPECT_EQ(mesh.vertices.cols(), 17061);
  EXPECT_EQ(mesh.triangles.cols(), 33600);
  // The sheet is 120 x 140 mm about the axis, and one disk: V - E + F = 1 (Euler).
  const Eigen::Vector3d extent =
      mesh.vertices.rowwise().maxCoeff() - mesh.vertices.rowwise().minCoeff();
  EXPECT_EQ(extent.x(), 120);
  EXPECT_EQ(extent.y(), 140);
  std::set<std::pair<int, int>> edges;
  for (const auto& triangle : mesh.triangles.colwise())
    for (int i = 0; i < 3; ++i) edges.insert(std::minmax(triangle[i], triangle[(i + 1) % 3]));
  EXPECT_EQ(17061 - static_cast<int>(edges.size()) + 33600, 1);
}

TEST(Ply, ReadsBothByteOrdersAnyTypesAndSkipsTheRest) {
  const ScratchFolder folder;
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    write_text(folder / "mesh.ply", rich_binary(order));
    const TriangleMesh mesh = read_mesh(folder / "mesh.ply");
    ASSERT_EQ(mesh.vertices.cols(), 3);
    for (int i = 0; i < 3; ++i)
      EXPECT_EQ(mesh.vertices.col(i), Eigen::Vector3d(-300.0 * i, double{0.7F}, 0.1 + i));
    ASSERT_EQ(mesh.triangles.cols(), 1);
    EXPECT_EQ(mesh.triangles.col(0), Eigen::Vector3i(2, 0, 1));
  }
}

TEST(Ply, ReadsTextToTheLastDigit) {
  const ScratchFolder folder;
  write_text(folder / "mesh.ply", replaced(kSquare, "0 0 0.1", "+1e-3 -1234.5678901234567 0.1"));
  const TriangleMesh mesh = read_mesh(folder / "mesh.ply");
  EXPECT_EQ(mesh.vertices.col(0), Eigen::Vector3d(1e-3, -1234.5678901234567, 0.1));
  EXPECT_EQ(mesh.triangles.cols(), 2);
}

TEST(Ply, TellsHowMuchOfATruncatedFileIsThere) {
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex 1000\nproperty float x\n"
      "property float y\nproperty float z\nend_header\n";
  expect_ply_refused(header + std::string(700 * 12 + 5, '\1'),
                     "holds at most 700 of 1000 rows of element vertex");
  expect_ply_refused(replaced(kSquare, "1 1 0.1\n0 1 0.1\n4 0 1 2 3\n", "1 1 0.1\n"),
                     "vertex 3 of 4: the file ends here");
  expect_ply_refused(replaced(kSquare, "4 0 1 2 3\n", "4 0 1"), "face 0 of 1: the file ends here");
}

TEST(Ply, RefusesEveryTruncation) {
  const ScratchFolder folder;
  for (const std::string& whole : {rich_binary(std::endian::little), rich_binary(std::endian::big)})
    for (std::size_t size = 0; size < whole.size(); ++size) {
      overwrite(folder / "mesh.ply", whole.substr(0, size));
      EXPECT_THROW(static_cast<void>(read_mesh(folder / "mesh.ply")), FileError) << size;
    }
}

TEST(Ply, AHugeCountTakesNoMemory) {
  for (const char* count : {"4000000000", "18446744073709551615"}) {
    expect_ply_refused(replaced(kSquare, "vertex 4", std::string("vertex ") + count),
                       std::string("of ") + count);
    expect_ply_refused(replaced(kSquare, "face 1", std::string("face ") + count),
                       std::string("of ") + count);
  }
  expect_ply_refused(replaced(kSquare, "vertex 4", "vertex 99999999999999999999"),
                     "line 3 of the header");
  expect_ply_refused(replaced(kSquare, "4 0 1 2 3", "250 0 1 2 3"), "the file ends here");
  expect_ply_refused(replaced(kSquare, "4 0 1 2 3", "2000000000 0 1 2 3"),
                     "\"2000000000\" is not a number of type uchar");
  const std::string wide = replaced(kSquare, "list uchar", "list int");
  expect_ply_refused(replaced(wide, "4 0 1 2 3", "2000000000 0 1 2 3"), "the file ends here");
  expect_ply_refused(replaced(wide, "4 0 1 2 3", "-4 0 1 2 3"),
                     "size of list vertex_indices is -4, which is impossible");
}

TEST(Ply, RefusesABadIndexByFaceAndCorner) {
  expect_ply_refused(replaced(kSquare, "4 0 1 2 3", "4 0 1 2 4"),
                     "face 0, corner 3: there is no vertex 4; the file has 4");
  expect_ply_refused(replaced(kSquare, "4 0 1 2 3", "4 0 1 -2 3"),
                     "corner 2: there is no vertex -2");
  expect_ply_refused(replaced(kSquare, "4 0 1 2 3", "4 0 1.5 2 3"),
                     "line 14: \"1.5\" is not a number of type int for property vertex_indices");
  expect_ply_refused(replaced(kSquare, "4 0 1 2 3", "2 0 1"), "has 2 corners; at least 3");
}

TEST(Ply, RefusesWhatIsNoPlyOrNoSurface) {
  expect_ply_refused("a letter\nto a friend\n", "first line must be \"ply\"");
  expect_ply_refused("ply\nelement vertex 0\nend_header\n", "no line \"format ...\"");
  expect_ply_refused(replaced(kSquare, "ascii", "morse"), "line 2 of the header is not valid");
  expect_ply_refused(replaced(kSquare, "float y", "quad y"), "line 5 of the header");
  expect_ply_refused(replaced(kSquare, "float y", "float w"), "needs one property y");
  expect_ply_refused(replaced(kSquare, "uchar int", "uchar float"),
                     "list vertex_indices of integers");
  expect_ply_refused(replaced(kSquare, "uchar int", "float int"), "line 8 of the header");
  expect_ply_refused(replaced(kSquare, "1 1 0.1", "1 one 0.1"), "line 12: \"one\" is not a number");
  expect_ply_refused(replaced(kSquare, "1 1 0.1", "1 nan 0.1"),
                     "vertex 2 (counted from 0) is not finite");
  expect_ply_refused(kTextVertices + "end_header\n0 0 1 1 0 1 1 1 1 0 1 1", "no triangle");
}

/// A strip of four vertices, a new start at an odd place, and a strip that repeats a vertex, as
/// some do to change the side.
std::string strips(const std::string& type) {
  return replaced(kTextVertices, "vertex 4", "vertex 5") +
         "property uchar red\nelement tristrips 2\nproperty list int " + type +
         " vertex_indices\nend_header\n0 0 0 1\n1 0 0 2\n0 1 0 3\n1 1 0 4\n0 2 0 5\n"
         "8 0 1 2 3 -1 2 3 4\n4 0 0 1 2\n";
}

TEST(Ply, StripsBecomeTrianglesThatFaceOneWay) {
  const ScratchFolder folder;
  for (const char* type : {"int", "short"}) {
    write_text(folder / "mesh.ply", strips(type));
    const MeshFile file = read_mesh_file(folder / "mesh.ply");
    Eigen::Matrix3Xi expected(3, 4);
    // Of 0 0 1 2 the first triangle has no area, and the second is the odd one of its strip.
    expected << 0, 2, 2, 1,  //
        1, 1, 3, 0,          //
        2, 3, 4, 2;
    EXPECT_EQ(file.mesh.triangles, expected) << file.mesh.triangles;
    EXPECT_EQ(*scalars(file.vertex_attributes, "red"),
              (Eigen::VectorXd(5) << 1, 2, 3, 4, 5).finished());
    EXPECT_EQ(triangle_normals(file.mesh).row(2).head(3), Eigen::RowVector3d(1, 1, 1));
  }
  expect_ply_refused(replaced(strips("int"), "-1 2 3 4", "-2 2 3 4"), "there is no vertex -2");
  expect_ply_refused(replaced(strips("int"), "-1 2 3 4", "-1 2 3 5"), "there is no vertex 5");
}

TEST(Ply, KeepsEveryPropertyAndComment) {
  const ScratchFolder folder;
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    write_text(folder / "mesh.ply", rich_binary(order));
    const MeshFile file = read_mesh_file(folder / "mesh.ply");
    ASSERT_EQ(file.vertex_attributes.size(), 2U);  // except for x, y and z
    EXPECT_EQ(file.vertex_attributes[0].name, "quality");
    EXPECT_EQ(std::get<std::vector<std::uint8_t>>(file.vertex_attributes[0].values),
              std::vector<std::uint8_t>(3, 7));
    EXPECT_EQ(file.vertex_attributes[1].list_sizes, std::vector<int>(3, 2));
    EXPECT_EQ(std::get<std::vector<std::int8_t>>(file.vertex_attributes[1].values),
              std::vector<std::int8_t>(6, 1));
    ASSERT_EQ(file.triangle_attributes.size(), 1U);
    EXPECT_EQ(*scalars(file.triangle_attributes, "area"), Eigen::VectorXd::Constant(1, 3));
    EXPECT_EQ(file.comments, (std::vector<std::string>{"made by a test", "none"}));
  }
}

TEST(Ply, NumbersMayBeWrittenInOtherWays) {
  const ScratchFolder folder;
  write_text(folder / "points.ply", kTextVertices +
                                        "property uchar red\nproperty float w\nend_header\n"
                                        "0 0 0 255.0 1e-50\n0 0 0 2e2 -nan\n0 0 0 +7 INF\n"
                                        "0 0 0 0x 1\n");
  EXPECT_THROWS_MESSAGE(static_cast<void>(read_points(folder / "points.ply")), FileError,
                        "line 13: \"0x\" is not a number of type uchar for property red");
  write_text(folder / "points.ply", replaced(read_text(folder / "points.ply"), "0x", "0"));
  const PointCloud cloud = read_point_cloud(folder / "points.ply");
  EXPECT_EQ(*scalars(cloud.attributes, "red"), Eigen::Vector4d(255, 200, 7, 0));
  EXPECT_EQ((*scalars(cloud.attributes, "w"))[0], 0);
  EXPECT_EQ((*scalars(cloud.attributes, "w"))[2], std::numeric_limits<double>::infinity());
  for (const char* wrong : {"256", "-1", "0.5", "nan"}) {
    write_text(folder / "wrong.ply", replaced(read_text(folder / "points.ply"), "255.0", wrong));
    EXPECT_THROWS_MESSAGE(static_cast<void>(read_points(folder / "wrong.ply")), FileError,
                          "is not a number of type uchar");
  }
}

TEST(Ply, LinesOfAHeaderMayEndInEveryWay) {
  const ScratchFolder folder;
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    std::string content;
    for (const char c : kSquare) content += c == '\n' ? end : std::string(1, c);
    write_text(folder / "mesh.ply", content);
    EXPECT_EQ(read_mesh(folder / "mesh.ply").triangles.cols(), 2);
  }
}

TEST(Ply, RefusesWhatIsThereTwice) {
  expect_ply_refused(replaced(kSquare, "float y\n", "float y\nproperty int y\n"),
                     "line 6 of the header");
  expect_ply_refused(replaced(kSquare, "end_header", "element vertex 0\nend_header"),
                     "line 9 of the header");
  expect_ply_refused(
      replaced(replaced(kSquare, "end_header", "property list uchar int vertex_index\nend_header"),
               "4 0 1 2 3", "4 0 1 2 3 3 0 1 2"),
      "needs one list vertex_indices");
}

TEST(Ply, PointsNeedNoFacesAndMayBeUnknown) {
  const ScratchFolder folder;
  write_text(folder / "points.ply",
             kTextVertices + "end_header\n0 0 1\nnan nan nan\n1 1 1\n0 0.1 1\n");
  const Eigen::Matrix3Xd points = read_points(folder / "points.ply");
  ASSERT_EQ(points.cols(), 4);
  EXPECT_TRUE(points.col(1).array().isNaN().all());
  EXPECT_EQ(points.col(3), Eigen::Vector3d(0, 0.1, 1));
}

}  // namespace
}  // namespace palpate::geometry
