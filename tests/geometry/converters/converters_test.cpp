// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Simple_cartesian.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "mesh_corpus.h"
#include "palpate/geometry/cgal_mesh.h"
#include "palpate/geometry/cgal_point_set.h"
#include "palpate/geometry/cgal_properties.h"
#include "palpate/geometry/cgal_views.h"
#include "palpate/geometry/eigen_views.h"
#include "palpate/geometry/pcl_cloud.h"
#include "palpate/geometry/range_map_cloud.h"
#include "refusal.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using Point = CGAL::Simple_cartesian<double>::Point_3;

TEST(EigenViews, RowsLookAtTheSameMemoryAsColumns) {
  TriangleMesh mesh = test::icosphere(1, 10.1);
  auto rows = as_rows(mesh.vertices);
  ASSERT_EQ(rows.rows(), mesh.vertices.cols());
  EXPECT_EQ(rows.data(), mesh.vertices.data());
  EXPECT_EQ(rows(7, 2), mesh.vertices(2, 7));
  rows(7, 2) = 0.7;
  EXPECT_EQ(mesh.vertices(2, 7), 0.7);
  const Rows3<double> copy = rows;
  EXPECT_EQ(as_columns(copy), mesh.vertices);
  EXPECT_EQ(as_columns(copy).data(), copy.data());
  EXPECT_EQ(as_rows(std::as_const(mesh.triangles)).row(3), mesh.triangles.col(3).transpose());
}

TEST(EigenViews, AListOfPointsIsAMatrixOfColumns) {
  const std::vector<Eigen::Vector3d> list = {{0.1, 0.2, 0.3}, {1000.1, 0.7, -4.4}};
  const auto columns = as_columns(list);
  EXPECT_EQ(columns.data(), list.front().data());
  EXPECT_EQ(columns.col(1), list[1]);
  EXPECT_EQ(as_columns(std::vector<Eigen::Vector3d>()).cols(), 0);
}

TEST(CgalMesh, ARoundTripKeepsEveryNumberAndTheOrder) {
  for (const TriangleMesh& mesh :
       {test::bumpy(3000, 0.25), test::glove(9), test::torus(20, 7, 30.1, 4.7)}) {
    const TriangleMesh back = from_surface_mesh(to_surface_mesh<Point>(mesh));
    EXPECT_EQ(back.vertices, mesh.vertices);
    // CGAL may begin a face at another of its corners.
    ASSERT_EQ(back.triangles.cols(), mesh.triangles.cols());
    for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
      Eigen::Vector3i turned = back.triangles.col(t);
      for (int turn = 0; turn < 2 && turned != mesh.triangles.col(t); ++turn)
        turned = Eigen::Vector3i(turned[1], turned[2], turned[0]);
      EXPECT_EQ(turned, mesh.triangles.col(t));
    }
  }
}

TEST(CgalMesh, RemovedVerticesAreLeftOut) {
  auto surface = to_surface_mesh<Point>(test::flat_sheet(2, 1, 1.5));
  surface.remove_face(*surface.faces().begin());
  surface.remove_vertex(surface.add_vertex(Point(9, 9, 9)));
  EXPECT_EQ(from_surface_mesh(surface).triangles.cols(), 3);
  EXPECT_EQ(from_surface_mesh(surface).vertices.cols(), 6);
}

TEST(CgalMesh, WhatIsNotManifoldIsNamed) {
  TriangleMesh mesh = test::flat_sheet(1, 1, 1.5);
  mesh.triangles.col(1).reverseInPlace();
  EXPECT_NE(refusal([&] { (void)to_surface_mesh<Point>(mesh); }).find("triangle 1"),
            std::string::npos);
}

TEST(CgalMesh, AQuadrangleIsNamed) {
  CGAL::Surface_mesh<Point> surface;
  const auto a = surface.add_vertex(Point(0, 0, 0));
  const auto b = surface.add_vertex(Point(1, 0, 0));
  const auto c = surface.add_vertex(Point(1, 1, 0));
  const auto d = surface.add_vertex(Point(0, 1, 0));
  surface.add_face(a, b, c, d);
  EXPECT_NE(refusal([&] { (void)from_surface_mesh(surface); }).find("face 0 has 4 corners"),
            std::string::npos);
}

/// A slope seen through a lens, with an unknown depth.
RangeMap small_map() {
  RangeMap map;
  map.camera = {.width = 4, .height = 3, .fx = 100, .fy = 90, .cx = 1.4, .cy = 0.9};
  map.camera.distortion[0] = -0.1;
  map.z.resize(3, 4);
  for (int i = 0; i < 12; ++i) map.z.data()[i] = 500.1F + 3.3F * static_cast<float>(i);
  map.z(1, 2) = std::numeric_limits<float>::quiet_NaN();
  return map;
}

// A torus with normals, colours and numbers of two types at its vertices, and numbers of triangles.
MeshFile described_torus() {
  MeshFile file;
  file.mesh = test::torus(20, 7, 30.1, 4.7);
  const Eigen::Index vertices = file.mesh.vertices.cols();
  set_normals(file.vertex_attributes, vertex_normals(file.mesh).cast<float>().cast<double>());
  Eigen::Matrix3Xd rgb(3, vertices);
  for (Eigen::Index v = 0; v < vertices; ++v)
    rgb.col(v) << static_cast<double>(v % 256) / 255, 0.2, 1 - static_cast<double>(v % 64) / 255;
  set_colors(file.vertex_attributes, rgb);
  std::vector<double> depth;
  std::vector<std::uint16_t> label;
  for (Eigen::Index v = 0; v < vertices; ++v) {
    depth.push_back(0.1 * static_cast<double>(v));
    label.push_back(static_cast<std::uint16_t>(60000 + v));
  }
  set_attribute(file.vertex_attributes, {.name = "depth", .values = depth, .list_sizes = {}});
  set_attribute(file.vertex_attributes, {.name = "label", .values = label, .list_sizes = {}});
  std::vector<float> area(static_cast<std::size_t>(file.mesh.triangles.cols()));
  for (std::size_t t = 0; t < area.size(); ++t) area[t] = 0.3F * static_cast<float>(t);
  set_attribute(file.triangle_attributes, {.name = "area", .values = area, .list_sizes = {}});
  return file;
}

void expect_same(const Attributes& found, const Attributes& expected) {
  EXPECT_EQ(found.size(), expected.size());
  EXPECT_EQ(normals(found), normals(expected));
  EXPECT_EQ(colors(found), colors(expected));
  for (const char* name : {"depth", "label", "area"}) {
    const Attribute* a = find_attribute(found, name);
    const Attribute* b = find_attribute(expected, name);
    ASSERT_EQ(a == nullptr, b == nullptr) << name;
    if (a) {
      EXPECT_EQ(a->values, b->values) << name;
    }
  }
}

// Without the alpha that CGAL adds.
Attributes without_alpha(Attributes attributes) {
  std::erase_if(attributes, [](const Attribute& each) { return each.name == "alpha"; });
  return attributes;
}

TEST(CgalProperties, ARoundTripKeepsNormalsColoursAndNumbersInTheirTypes) {
  const MeshFile file = described_torus();
  const auto surface = to_surface_mesh<Point>(file);
  const auto color = surface.property_map<CGAL::SM_Vertex_index, CGAL::IO::Color>("v:color");
  ASSERT_TRUE(color.second);
  EXPECT_EQ(color.first[CGAL::SM_Vertex_index(7)], CGAL::IO::Color(7, 51, 248));
  const MeshFile back = mesh_file_of(surface);
  EXPECT_EQ(back.mesh.vertices, file.mesh.vertices);
  expect_same(without_alpha(back.vertex_attributes), file.vertex_attributes);
  expect_same(back.triangle_attributes, file.triangle_attributes);
}

TEST(CgalProperties, OfRemovedVerticesAreLeftOut) {
  MeshFile file = described_torus();
  auto surface = to_surface_mesh<Point>(file);
  const CGAL::SM_Vertex_index first(0);
  for (const auto face : surface.faces_around_target(surface.halfedge(first)))
    if (face != surface.null_face()) surface.remove_face(face);
  surface.remove_vertex(first);
  const MeshFile back = mesh_file_of(surface);
  EXPECT_EQ((*scalars(back.vertex_attributes, "depth"))[0], 0.1);
}

TEST(CgalViews, AreTheMemoryOfTheMapsOfAMesh) {
  using Exact = CGAL::Exact_predicates_inexact_constructions_kernel;
  auto surface = to_surface_mesh<Exact::Point_3>(described_torus());
  const CGAL::SM_Vertex_index seventh(7);
  const auto points = columns_of(surface.points());
  EXPECT_EQ(points, described_torus().mesh.vertices);
  columns_of(surface.points())(2, 7) = 0.7;
  EXPECT_EQ(surface.point(seventh).z(), 0.7);
  const auto normal =
      surface.property_map<CGAL::SM_Vertex_index, Exact::Vector_3>("v:normal").first;
  EXPECT_EQ(columns_of(normal)(1, 7), normal[seventh].y());
  auto depth = surface.property_map<CGAL::SM_Vertex_index, double>("v:depth").first;
  values_of(depth) = points.row(2).transpose();
  EXPECT_EQ(depth[seventh], 0.7);
  // Removed vertices have a column until the garbage is collected.
  surface.remove_vertex(surface.add_vertex(Exact::Point_3(9, 9, 9)));
  const Eigen::Index count = points.cols();
  EXPECT_EQ(columns_of(surface.points()).cols(), count + 1);
  surface.collect_garbage();
  EXPECT_EQ(columns_of(surface.points()).cols(), count);
}

TEST(CgalViews, AreTheMemoryOfAPointSet) {
  CGAL::Point_set_3<Point> set;
  EXPECT_EQ(columns_of(set.point_map()).cols(), 0);
  set.insert(Point(0.1, 0.2, 0.3));
  const auto second = *set.insert(Point(1000.1, 0.7, -4.4));
  columns_of(set.point_map()).col(1) *= 2;
  EXPECT_EQ(set.point(second), Point(2000.2, 1.4, -8.8));
  const auto label = set.add_property_map<std::uint16_t>("label", 3).first;
  EXPECT_EQ(values_of(label).sum(), 6);
}

TEST(CgalPointSet, ARoundTripKeepsKnownPointsWithTheirAttributes) {
  const MeshFile file = described_torus();
  PointCloud cloud;
  cloud.points = file.mesh.vertices;
  cloud.width = cloud.points.cols();
  cloud.attributes = file.vertex_attributes;
  const PointCloud back = from_point_set(to_point_set<Point>(cloud));
  EXPECT_EQ(back.points, cloud.points);
  expect_same(back.attributes, cloud.attributes);
  cloud.points(1, 3) = std::numeric_limits<double>::quiet_NaN();
  const PointCloud fewer = from_point_set(to_point_set<Point>(cloud));
  EXPECT_EQ(fewer.points.cols(), cloud.points.cols() - 1);
  EXPECT_EQ((*scalars(fewer.attributes, "depth"))[3], (*scalars(cloud.attributes, "depth"))[4]);
}

TEST(PclCloud2, ARoundTripKeepsAllAttributesInTheirTypes) {
  const MeshFile file = described_torus();
  const pcl::PolygonMesh polygons = to_polygon_mesh(file);
  pcl::PointCloud<pcl::PointXYZRGBNormal> read;
  pcl::fromPCLPointCloud2(polygons.cloud, read);  // PCL finds its own fields
  EXPECT_EQ(read[7].b, 248);
  EXPECT_EQ(read[7].normal_y, static_cast<float>((*normals(file.vertex_attributes))(1, 7)));
  const MeshFile back = mesh_file_of(polygons);
  EXPECT_EQ(back.mesh.triangles, file.mesh.triangles);
  EXPECT_EQ(back.mesh.vertices, file.mesh.vertices.cast<float>().cast<double>());
  expect_same(back.vertex_attributes, file.vertex_attributes);
}

TEST(PclCloud2, KeepsTheAlphaOfColoursThatHaveOne) {
  pcl::PointCloud<pcl::PointXYZRGBA> points(2, 1);
  points[1].r = 10;
  points[1].g = 20;
  points[1].b = 30;
  points[1].a = 40;
  pcl::PCLPointCloud2 packed;
  pcl::toPCLPointCloud2(points, packed);
  const auto bytes = color_bytes(from_pcl_cloud2(packed).attributes);
  ASSERT_TRUE(bytes);
  EXPECT_EQ(bytes->col(1).cast<int>(), Eigen::Vector4i(10, 20, 30, 40));
}

TEST(PclCloud, AnAttributeOfAnotherLengthIsRefused) {
  PointCloud cloud = organised_cloud(small_map());
  set_normals(cloud.attributes, Eigen::Matrix3Xd::Ones(3, 40));
  EXPECT_NE(refusal([&] { return to_point_cloud_of<pcl::PointNormal>(cloud); }).find("40 elements"),
            std::string::npos);
}

TEST(PclCloud2, NamesWhatIsMissing) {
  PointCloud cloud = organised_cloud(small_map());
  pcl::PCLPointCloud2 packed = to_pcl_cloud2(cloud);
  EXPECT_EQ(packed.height, 3U);
  packed.data.resize(packed.data.size() - 3);
  EXPECT_EQ(refusal([&] { return from_pcl_cloud2(packed); }),
            "point cloud: its data end within field z");
  packed.fields[1].name = "height";
  packed.data.resize(packed.data.size() + 3);
  EXPECT_EQ(refusal([&] { return from_pcl_cloud2(packed); }), "point cloud: has no field y");
}

TEST(PclCloud, ARoundTripKeepsPointsToTheRoundingOfFloat) {
  const TriangleMesh mesh = test::glove(9);
  const TriangleMesh back = from_polygon_mesh(to_polygon_mesh(mesh));
  EXPECT_EQ(back.triangles, mesh.triangles);
  EXPECT_EQ(back.vertices, mesh.vertices.cast<float>().cast<double>());
}

TEST(PclCloud, ARangeMapBecomesAnOrganisedCloud) {
  RangeMap map;
  map.camera = {.width = 3, .height = 2, .fx = 100, .fy = 100, .cx = 1, .cy = 0.5};
  map.z = ImageF::Constant(2, 3, 700.1F);
  map.z(1, 2) = std::numeric_limits<float>::quiet_NaN();
  const auto cloud = to_point_cloud(map);
  EXPECT_EQ(cloud.width, 3U);
  EXPECT_EQ(cloud.height, 2U);
  EXPECT_FALSE(cloud.is_dense);
  EXPECT_FLOAT_EQ(cloud.at(0, 1).x, -7.001F);
  EXPECT_TRUE(std::isnan(cloud.at(2, 1).z));
}

TEST(PclCloud, OfARangeMapHasTheRoundedPointsOfItsBackProjection) {
  const RangeMap map = small_map();
  const auto cloud = to_point_cloud(map);
  const Eigen::Matrix3Xf expected = back_project(map).cast<float>();
  for (Eigen::Index i = 0; i < 12; ++i) {
    if (i != 6) {
      EXPECT_EQ(positions(cloud).col(i), expected.col(i));
    } else {
      EXPECT_TRUE(std::isnan(cloud[6].x) && std::isnan(cloud[6].z));
    }
  }
  RangeMap wrong = map;
  wrong.camera.width = 5;
  EXPECT_EQ(refusal([&] { return to_point_cloud(wrong); }),
            "range map: depths are 4 x 3 px, but the camera is 5 x 3 px");
}

TEST(PclCloud, ViewsAreTheMemoryOfTheCloud) {
  const RangeMap map = small_map();
  pcl::PointCloud<pcl::PointNormal> cloud =
      to_point_cloud_of<pcl::PointNormal>(organised_cloud(map));
  const auto depths = depths_in(cloud);
  ASSERT_EQ(depths.rows(), 3);
  ASSERT_EQ(depths.cols(), 4);
  EXPECT_EQ(depths(2, 1), map.z(2, 1));
  cloud.at(1, 2).z = 9;
  EXPECT_EQ(depths(2, 1), 9);
  positions(cloud)(1, 5) = 77;
  EXPECT_EQ(cloud[5].y, 77);
  cloud[5].normal_z = 3;
  EXPECT_EQ(normals_in(std::as_const(cloud))(2, 5), 3);
  pcl::PointCloud<pcl::PointXYZ> empty;
  EXPECT_EQ(positions(empty).cols(), 0);
  EXPECT_EQ(depths_in(empty).size(), 0);
}

TEST(PclCloud, ARoundTripKeepsGridNormalsAndColours) {
  PointCloud cloud = organised_cloud(small_map());
  Eigen::Matrix3Xd normals = Eigen::Matrix3Xd::Zero(3, 12);
  normals.row(1).setLinSpaced(0, 0.5);
  normals = normals.cast<float>().cast<double>();
  set_normals(cloud.attributes, normals);
  Eigen::Matrix3Xd rgb(3, 12);
  for (int i = 0; i < 12; ++i) rgb.col(i) << i / 255.0, 1 - i / 255.0, 0.2;
  set_colors(cloud.attributes, rgb);
  const PointCloud back = from_point_cloud_of(to_point_cloud_of<pcl::PointXYZRGBNormal>(cloud));
  EXPECT_EQ(back.width, 4);
  EXPECT_EQ(back.height, 3);
  EXPECT_EQ(*geometry::normals(back.attributes), normals);
  EXPECT_EQ(*colors(back.attributes), *colors(cloud.attributes));
  const RangeMap map = range_map_of(back, small_map().camera);
  for (int i = 0; i < 12; ++i) {
    if (i == 6) continue;
    EXPECT_EQ(map.z.data()[i], small_map().z.data()[i]);
  }
  cloud.width = 5;
  EXPECT_EQ(refusal([&] { return to_point_cloud_of<pcl::PointXYZ>(cloud); }),
            "point cloud: is 5 x 3, but has 12 points");
}

TEST(PclCloud, AQuadrangleIsNamed) {
  pcl::PolygonMesh polygons = to_polygon_mesh(test::flat_sheet(1, 1, 1.5));
  polygons.polygons[1].vertices.push_back(0);
  EXPECT_NE(refusal([&] { (void)from_polygon_mesh(polygons); }).find("polygon 1 has 4 corners"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate::geometry
