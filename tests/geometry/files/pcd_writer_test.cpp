// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <limits>
#include <string>

#include "file_testing.h"
#include "files/random_mesh_file.h"
#include "palpate/core/error.h"
#include "palpate/geometry/mesh_io.h"

namespace palpate::geometry {
namespace {

/// Organised, with holes, attributes of all types, and lists of one size.
PointCloud random_cloud(unsigned seed) {
  std::mt19937_64 random(seed);
  PointCloud cloud;
  cloud.width = 7;
  cloud.height = 5;
  cloud.points = random_points(35, random);
  for (const int unknown : {0, 3, 34})
    cloud.points.col(unknown).setConstant(std::numeric_limits<double>::quiet_NaN());
  cloud.attributes = random_attributes(35, false, random);
  cloud.attributes.push_back(random_attribute<std::int64_t>("id", 35, false, random));
  cloud.attributes.push_back(random_attribute<std::uint64_t>("mark", 35, false, random));
  cloud.attributes.push_back(
      {"descriptor", std::vector<std::int16_t>(70, -300), std::vector<int>(35, 2)});
  cloud.comments = {"made by a test", ""};
  return cloud;
}

TEST(PcdWriter, EveryBitComesBackWithTheGrid) {
  const ScratchFolder folder;
  for (unsigned seed = 0; seed < 8; ++seed)
    for (const Encoding encoding : {Encoding::binary, Encoding::text}) {
      SCOPED_TRACE(::testing::Message() << "seed " << seed << ", encoding " << int(encoding));
      const PointCloud cloud = random_cloud(seed);
      write_point_cloud(folder / "points.pcd", cloud, {.encoding = encoding});
      const PointCloud read = read_point_cloud(folder / "points.pcd");
      EXPECT_TRUE(same_bits(read.points, cloud.points));
      EXPECT_EQ(read.width, 7);
      EXPECT_EQ(read.height, 5);
      EXPECT_EQ(read.comments, cloud.comments);
      EXPECT_EQ(read.unit.source, UnitSource::declared);
      expect_same(read.attributes, cloud.attributes);
    }
}

TEST(PcdWriter, CloudsGoThroughPlyWithoutTheGrid) {
  const ScratchFolder folder;
  PointCloud cloud = random_cloud(3);
  std::erase_if(cloud.attributes,
                [](const Attribute& a) { return a.name == "id" || a.name == "mark"; });
  for (const Encoding encoding : {Encoding::binary, Encoding::binary_big_endian, Encoding::text}) {
    write_point_cloud(folder / "points.ply", cloud, {.encoding = encoding});
    const PointCloud read = read_point_cloud(folder / "points.ply");
    EXPECT_TRUE(same_bits(read.points, cloud.points));
    EXPECT_EQ(read.width, 35);
    EXPECT_EQ(read.height, 1);
    expect_same(read.attributes, cloud.attributes);
  }
}

TEST(PcdWriter, PacksColorsAndNamesNormalsAsPclDoes) {
  const ScratchFolder folder;
  PointCloud cloud;
  cloud.points = Eigen::Vector3d(0.5, -1, 2);
  cloud.width = 1;
  set_colors(cloud.attributes, Eigen::Vector3d(1, 128.0 / 255, 3.0 / 255));
  set_normals(cloud.attributes, Eigen::Vector3d(0, 0, 1));
  write_point_cloud(folder / "points.pcd", cloud,
                    {.encoding = Encoding::text, .single_precision = true});
  EXPECT_EQ(read_text(folder / "points.pcd"),
            "# .PCD v0.7 - Point Cloud Data file format\n# unit mm\nVERSION 0.7\n"
            "FIELDS x y z normal_x normal_y normal_z rgb\nSIZE 4 4 4 4 4 4 4\n"
            "TYPE F F F F F F U\nCOUNT 1 1 1 1 1 1 1\nWIDTH 1\nHEIGHT 1\n"
            "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 1\nDATA ascii\n0.5 -1 2 0 0 1 16744451\n");
  for (const Encoding encoding : {Encoding::binary, Encoding::text}) {
    write_point_cloud(folder / "points.pcd", cloud, {.encoding = encoding});
    const PointCloud read = read_point_cloud(folder / "points.pcd");
    EXPECT_EQ(*colors(read.attributes), *colors(cloud.attributes));
    EXPECT_EQ(*normals(read.attributes), Eigen::Vector3d(0, 0, 1));
  }
  write_point_cloud(folder / "points.pcd", cloud, {.single_precision = true});
  EXPECT_NE(read_text(folder / "points.pcd").find("TYPE F F F F F F F\n"), std::string::npos);
}

TEST(PcdWriter, KeepsAlphaAsRgba) {
  const ScratchFolder folder;
  PointCloud cloud;
  cloud.points = Eigen::Vector3d(0.5, -1, 2);
  cloud.width = 1;
  set_colors(cloud.attributes, Eigen::Vector4d(1, 0.2, 0.4, 0.6));
  for (const Encoding encoding : {Encoding::binary, Encoding::text}) {
    write_point_cloud(folder / "points.pcd", cloud, {.encoding = encoding});
    expect_same(read_point_cloud(folder / "points.pcd").attributes, cloud.attributes);
  }
}

TEST(PcdWriter, RefusesWhatPcdCannotHold) {
  const ScratchFolder folder;
  const auto refuse = [&](const PointCloud& cloud, const std::string& words,
                          const std::string& name = "points.pcd") {
    EXPECT_THROWS_MESSAGE(write_point_cloud(folder / name, cloud), InvalidInput, words);
  };
  PointCloud cloud = random_cloud(0);
  cloud.width = 8;
  refuse(cloud, "35 points; width x height is 8 x 5");
  refuse(PointCloud(), "no points");
  cloud = random_cloud(0);
  refuse(cloud, "as .pcd or .ply, not as \".obj\"", "points.obj");
  cloud.attributes.back().list_sizes[3] = 1;
  cloud.attributes.back().list_sizes[4] = 3;
  refuse(cloud, "\"descriptor\" has lists of several sizes");
  cloud.attributes.back() = {"y", std::vector<float>(35), {}};
  refuse(cloud, "called \"y\"");
  EXPECT_EQ(folder.entries(), 0);
}

}  // namespace
}  // namespace palpate::geometry
