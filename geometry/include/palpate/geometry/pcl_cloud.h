// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pcl/PolygonMesh.h>
#include <pcl/conversions.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/type_traits.h>

#include <Eigen/Core>
#include <string>

#include "palpate/core/error.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/range_map.h"
#include "palpate/geometry/triangle_mesh.h"

/// \file
/// Conversion to and from PCL's PointCloud and PolygonMesh, whose coordinates are floats. No other
/// header of Palpate includes this one or needs PCL to compile; link PCL yourself.
///
/// PCL's clouds can be seen as matrices and depth images without a copy: `positions`, `normals_in`,
/// `depths_in`. All `to_...` and `from_...` functions copy, since Palpate's coordinates are double.
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
/// The points are written once, into the cloud.
/// \throws InvalidInput as `back_project`.
[[nodiscard]] inline pcl::PointCloud<pcl::PointXYZ> to_point_cloud(const RangeMap& map) {
  const Eigen::Matrix2Xd rays = pixel_rays(map.camera);
  if (map.z.rows() != map.camera.height || map.z.cols() != map.camera.width)
    throw InvalidInput("range map: depths are " + std::to_string(map.z.cols()) + " x " +
                       std::to_string(map.z.rows()) + " px, but the camera is " +
                       std::to_string(map.camera.width) + " x " +
                       std::to_string(map.camera.height) + " px");
  pcl::PointCloud<pcl::PointXYZ> cloud(static_cast<std::uint32_t>(map.z.cols()),
                                       static_cast<std::uint32_t>(map.z.rows()));
  for (Eigen::Index i = 0; i < map.z.size(); ++i) {
    const double z = map.z.data()[i];
    const Eigen::Vector3d point(z * rays(0, i), z * rays(1, i), z);
    cloud[static_cast<size_t>(i)].getVector3fMap() = point.cast<float>();
    cloud.is_dense = cloud.is_dense && point.allFinite();
  }
  return cloud;
}

/// Coordinates of a cloud as a 3 x N matrix, without a copy: writing to the view writes to the
/// cloud. It is valid as long as the cloud is neither moved nor resized.
template <class Point>
[[nodiscard]] auto positions(pcl::PointCloud<Point>& cloud) {
  using View = Eigen::Map<Eigen::Matrix3Xf, Eigen::Unaligned, Eigen::OuterStride<>>;
  return View(cloud.empty() ? nullptr : cloud[0].data, 3, static_cast<Eigen::Index>(cloud.size()),
              Eigen::OuterStride<>(sizeof(Point) / sizeof(float)));
}
template <class Point>
[[nodiscard]] auto positions(const pcl::PointCloud<Point>& cloud) {
  using View = Eigen::Map<const Eigen::Matrix3Xf, Eigen::Unaligned, Eigen::OuterStride<>>;
  return View(cloud.empty() ? nullptr : cloud[0].data, 3, static_cast<Eigen::Index>(cloud.size()),
              Eigen::OuterStride<>(sizeof(Point) / sizeof(float)));
}

/// Normals of a cloud as a 3 x N matrix, in the same way.
/// \tparam Point  any of PCL's point types with normals.
template <class Point>
[[nodiscard]] auto normals_in(const pcl::PointCloud<Point>& cloud) {
  using View = Eigen::Map<const Eigen::Matrix3Xf, Eigen::Unaligned, Eigen::OuterStride<>>;
  return View(cloud.empty() ? nullptr : cloud[0].data_n, 3, static_cast<Eigen::Index>(cloud.size()),
              Eigen::OuterStride<>(sizeof(Point) / sizeof(float)));
}

/// The Z of an organised cloud as an image of height x width, in the same way: the depths of its
/// range map if it is in the frame of a camera.
template <class Point>
[[nodiscard]] auto depths_in(const pcl::PointCloud<Point>& cloud) {
  using Strides = Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>;
  using View = Eigen::Map<const ImageF, Eigen::Unaligned, Strides>;
  constexpr Eigen::Index kFloats = sizeof(Point) / sizeof(float);
  return View(cloud.empty() ? nullptr : &cloud[0].z, static_cast<Eigen::Index>(cloud.height),
              static_cast<Eigen::Index>(cloud.width),
              Strides(kFloats * static_cast<Eigen::Index>(cloud.width), kFloats));
}

/// Converts a cloud with what its attributes and the type of points both have of normals and
/// colours, as organised as before; fields without an attribute keep PCL's default.
/// \tparam Point  any of PCL's point types with x, y and z.
/// \throws InvalidInput unless width * height is the number of points.
template <class Point>
[[nodiscard]] pcl::PointCloud<Point> to_point_cloud_of(const PointCloud& from) {
  if (from.width * from.height != from.points.cols())
    throw InvalidInput("point cloud: is " + std::to_string(from.width) + " x " +
                       std::to_string(from.height) + ", but has " +
                       std::to_string(from.points.cols()) + " points");
  pcl::PointCloud<Point> cloud(static_cast<std::uint32_t>(from.width),
                               static_cast<std::uint32_t>(from.height));
  positions(cloud) = from.points.cast<float>();
  cloud.is_dense = from.points.allFinite();
  if constexpr (pcl::traits::has_normal<Point>::value) {
    if (const auto found = normals(from.attributes)) {
      for (Eigen::Index i = 0; i < found->cols(); ++i)
        cloud[static_cast<size_t>(i)].getNormalVector3fMap() = found->col(i).cast<float>();
    }
  }
  if constexpr (pcl::traits::has_color<Point>::value) {
    if (const auto found = colors(from.attributes)) {
      for (Eigen::Index i = 0; i < found->cols(); ++i) {
        const Eigen::Array4d share = found->col(i).array();
        const Eigen::Array4d bytes = (share >= 0).select((share * 255).round().min(255), 0);
        Point& point = cloud[static_cast<size_t>(i)];
        point.r = static_cast<std::uint8_t>(bytes[0]);
        point.g = static_cast<std::uint8_t>(bytes[1]);
        point.b = static_cast<std::uint8_t>(bytes[2]);
      }
    }
  }
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

/// Converts a cloud with its normals and colours, as organised as before; `range_map_of` makes a
/// range map of it.
/// \tparam Point  any of PCL's point types with x, y and z.
template <class Point>
[[nodiscard]] PointCloud from_point_cloud_of(const pcl::PointCloud<Point>& from) {
  PointCloud cloud;
  cloud.points = positions(from).template cast<double>();
  cloud.width = static_cast<Eigen::Index>(from.width);
  cloud.height = static_cast<Eigen::Index>(from.height);
  if constexpr (pcl::traits::has_normal<Point>::value)
    set_normals(cloud.attributes, normals_in(from).template cast<double>());
  if constexpr (pcl::traits::has_color<Point>::value) {
    Eigen::Matrix3Xd rgb(3, static_cast<Eigen::Index>(from.size()));
    for (size_t i = 0; i < from.size(); ++i)
      rgb.col(static_cast<Eigen::Index>(i)) << from[i].r, from[i].g, from[i].b;
    set_colors(cloud.attributes, rgb / 255);
  }
  return cloud;
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
