// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pcl/PolygonMesh.h>
#include <pcl/conversions.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <Eigen/Core>
#include <string>

#include "palpate/error.h"
#include "palpate/geometry/range_map.h"
#include "palpate/geometry/triangle_mesh.h"

/// Conversion to and from PCL's PointCloud and PolygonMesh, whose coordinates are floats. No other
/// header of Palpate includes this one or needs PCL to compile; link PCL yourself.
namespace palpate::geometry {

/// Converts points (3 x N) to a cloud of N x 1, without a change of unit; `is_dense` iff all are
/// finite.
[[nodiscard]] inline pcl::PointCloud<pcl::PointXYZ> to_point_cloud(
    const Eigen::Ref<const Eigen::Matrix3Xd>& points) {
  pcl::PointCloud<pcl::PointXYZ> cloud;
  cloud.resize(static_cast<size_t>(points.cols()));
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    cloud[static_cast<size_t>(i)].getVector3fMap() = points.col(i).cast<float>();
  cloud.is_dense = points.allFinite();
  return cloud;
}

/// Converts a range map to an organised cloud, camera frame [mm]; NaN where the depth is unknown.
/// \throws InvalidInput as `back_project`.
[[nodiscard]] inline pcl::PointCloud<pcl::PointXYZ> to_point_cloud(const RangeMap& map) {
  pcl::PointCloud<pcl::PointXYZ> cloud = to_point_cloud(back_project(map));
  cloud.width = static_cast<std::uint32_t>(map.z.cols());
  cloud.height = static_cast<std::uint32_t>(map.z.rows());
  return cloud;
}

/// Positions of a cloud, 3 x N, row by row if it is organised.
/// \tparam Point  any of PCL's point types with x, y and z.
template <class Point>
[[nodiscard]] Eigen::Matrix3Xd from_point_cloud(const pcl::PointCloud<Point>& cloud) {
  Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(cloud.size()));
  for (size_t i = 0; i < cloud.size(); ++i) {
    points.col(static_cast<Eigen::Index>(i)) = cloud[i].getVector3fMap().template cast<double>();
  }
  return points;
}

/// Converts a mesh.
/// \throws InvalidInput if the mesh is not valid.
[[nodiscard]] inline pcl::PolygonMesh to_polygon_mesh(const TriangleMesh& mesh) {
  check_mesh(mesh, "mesh");
  pcl::PolygonMesh polygons;
  pcl::toPCLPointCloud2(to_point_cloud(mesh.vertices), polygons.cloud);
  polygons.polygons.resize(static_cast<size_t>(mesh.triangles.cols()));
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const auto corners = mesh.triangles.col(t).cast<pcl::index_t>();
    polygons.polygons[static_cast<size_t>(t)].vertices.assign({corners[0], corners[1], corners[2]});
  }
  return polygons;
}

/// Converts a mesh; vertices and triangles keep their order.
/// \throws InvalidInput naming a polygon that is not a triangle, or if `check_mesh` fails.
[[nodiscard]] inline TriangleMesh from_polygon_mesh(const pcl::PolygonMesh& polygons) {
  pcl::PointCloud<pcl::PointXYZ> cloud;
  pcl::fromPCLPointCloud2(polygons.cloud, cloud);
  TriangleMesh mesh;
  mesh.vertices = from_point_cloud(cloud);
  mesh.triangles.resize(3, static_cast<Eigen::Index>(polygons.polygons.size()));
  for (size_t t = 0; t < polygons.polygons.size(); ++t) {
    const pcl::Indices& corners = polygons.polygons[t].vertices;
    if (corners.size() != 3) {
      throw InvalidInput("polygon mesh: polygon " + std::to_string(t) + " has " +
                         std::to_string(corners.size()) + " corners, not 3: triangulate it first");
    }
    mesh.triangles.col(static_cast<Eigen::Index>(t)) << corners[0], corners[1], corners[2];
  }
  check_mesh(mesh, "polygon mesh");
  return mesh;
}

}  // namespace palpate::geometry
