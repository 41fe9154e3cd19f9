// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <limits>
#include <string>

#include "file_testing.h"
#include "files/random_mesh_file.h"
#include "palpate/core/error.h"
#include "palpate/geometry/mesh_io.h"

namespace palpate::geometry {
namespace {

constexpr std::array<Encoding, 3> kEncodings{Encoding::binary, Encoding::binary_big_endian,
                                             Encoding::text};

TEST(PlyWriter, EveryBitOfEveryTypeComesBackInEachEncoding) {
  const ScratchFolder folder;
  for (unsigned seed = 0; seed < 12; ++seed) {
    const MeshFile written = random_mesh_file(seed);
    for (const Encoding encoding : kEncodings) {
      SCOPED_TRACE(::testing::Message() << "seed " << seed << ", encoding " << int(encoding));
      write_mesh_file(folder / "mesh.ply", written, {.encoding = encoding});
      const MeshFile read = read_mesh_file(folder / "mesh.ply");
      expect_same(read, written);
      EXPECT_EQ(read.unit.length, 1);
      EXPECT_EQ(read.unit.source, UnitSource::declared);
    }
  }
}

TEST(PlyWriter, NanPayloadsSurviveInBinary) {
  const ScratchFolder folder;
  MeshFile file = random_mesh_file(0);
  // A signalling NaN turns quiet as soon as it is converted to another type.
  const std::vector<float> payload(static_cast<std::size_t>(file.mesh.vertices.cols()),
                                   std::bit_cast<float>(std::uint32_t{0xffa12345}));
  set_attribute(file.vertex_attributes, {"marks", payload, {}});
  for (const Encoding encoding : {Encoding::binary, Encoding::binary_big_endian}) {
    write_mesh_file(folder / "mesh.ply", file, {.encoding = encoding});
    expect_same(read_mesh_file(folder / "mesh.ply"), file);
  }
}

TEST(PlyWriter, LongListsGetALargerCount) {
  const ScratchFolder folder;
  MeshFile file = random_mesh_file(0);
  std::vector<int> sizes(static_cast<std::size_t>(file.mesh.vertices.cols()), 0);
  sizes[1] = 255;
  sizes[2] = 256;
  set_attribute(file.vertex_attributes, {"long", std::vector<std::uint8_t>(511, 9), sizes});
  for (const Encoding encoding : kEncodings) {
    write_mesh_file(folder / "mesh.ply", file, {.encoding = encoding});
    expect_same(read_mesh_file(folder / "mesh.ply"), file);
  }
}

TEST(PlyWriter, WritesTextAsTheFormatHasIt) {
  const ScratchFolder folder;
  MeshFile file;
  file.mesh.vertices = Eigen::Matrix3d::Identity() * 0.1;
  file.mesh.triangles.resize(3, 1);
  file.mesh.triangles << 0, 1, 2;
  file.vertex_attributes = {{"red", std::vector<std::uint8_t>{255, 0, 7}, {}}};
  file.triangle_attributes = {{"pair", std::vector<float>{0.5, -2}, {2}}};
  file.comments = {"by hand"};
  write_mesh_file(folder / "mesh.ply", file, {.encoding = Encoding::text});
  EXPECT_EQ(read_text(folder / "mesh.ply"),
            "ply\nformat ascii 1.0\ncomment unit mm\ncomment by hand\nelement vertex 3\n"
            "property double x\nproperty double y\nproperty double z\nproperty uchar red\n"
            "element face 1\nproperty list uchar int vertex_indices\n"
            "property list uchar float pair\nend_header\n"
            "0.1 0 0 255\n0 0.1 0 0\n0 0 0.1 7\n3 0 1 2 2 0.5 -2\n");
}

TEST(PlyWriter, SinglePrecisionRoundsToTheNearestFloat) {
  const ScratchFolder folder;
  MeshFile file;
  file.mesh = test::icosphere(1, 100.1);
  set_normals(file.vertex_attributes, vertex_normals(file.mesh));
  for (const Encoding encoding : kEncodings) {
    write_mesh_file(folder / "mesh.ply", file, {.encoding = encoding, .single_precision = true});
    const MeshFile read = read_mesh_file(folder / "mesh.ply");
    // A text has the digits of the nearest float, which are not those of its double.
    EXPECT_EQ(read.mesh.vertices.cast<float>(), file.mesh.vertices.cast<float>());
    EXPECT_EQ(*normals(read.vertex_attributes),
              normals(file.vertex_attributes)->cast<float>().cast<double>());
    EXPECT_TRUE(std::holds_alternative<std::vector<float>>(read.vertex_attributes[0].values));
  }
  file.mesh.vertices(2, 5) = 1e39;
  EXPECT_THROWS_MESSAGE(write_mesh_file(folder / "far.ply", file, {.single_precision = true}),
                        InvalidInput, "vertex 5 is beyond the range of float");
  EXPECT_EQ(folder.entries(), 1);
}

TEST(PlyWriter, RefusesAttributesThatPlyCannotHold) {
  const ScratchFolder folder;
  const auto refuse = [&](Attribute of_vertex, Attribute of_triangle, const std::string& words) {
    MeshFile file;
    file.mesh = test::icosphere(0, 1);  // 12 vertices, 20 triangles
    file.vertex_attributes.push_back(std::move(of_vertex));
    file.triangle_attributes.push_back(std::move(of_triangle));
    EXPECT_THROWS_MESSAGE(write_mesh_file(folder / "mesh.ply", file), InvalidInput, words);
  };
  const Attribute fine{"a", std::vector<double>(12), {}};
  const Attribute fine_too{"a", std::vector<double>(20), {}};
  refuse({"x", std::vector<double>(12), {}}, fine_too, "called \"x\", which PLY needs itself");
  refuse(fine, {"vertex_index", std::vector<int>(20), {}}, "called \"vertex_index\"");
  refuse({"id", std::vector<std::int64_t>(12), {}}, fine_too, "no 64-bit integers");
  refuse({"a", std::vector<double>(11), {}}, fine_too, "values of 11 elements; there are 12");
  refuse(fine, {"a", std::vector<double>(12), {}}, "values of 12 elements; there are 20");
  refuse({"two words", std::vector<double>(12), {}}, fine_too, "a name that is one word");
  EXPECT_EQ(folder.entries(), 0);
}

TEST(PlyWriter, RefusesCommentsThatWouldNotComeBack) {
  const ScratchFolder folder;
  MeshFile file;
  file.mesh = test::icosphere(0, 1);
  file.comments = {"fine", "two\nlines"};
  EXPECT_THROWS_MESSAGE(write_mesh_file(folder / "mesh.ply", file), InvalidInput,
                        "comment 1 has several lines");
  file.comments = {"unit: m"};
  EXPECT_THROWS_MESSAGE(write_mesh_file(folder / "mesh.ply", file), InvalidInput,
                        "comment 0 declares a unit");
}

}  // namespace
}  // namespace palpate::geometry
