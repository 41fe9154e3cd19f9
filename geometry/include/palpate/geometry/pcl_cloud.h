// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pcl/PCLPointCloud2.h>
#include <pcl/PolygonMesh.h>
#include <pcl/conversions.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/type_traits.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

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

namespace pcl_detail {

inline void check_cloud(const PointCloud& cloud) {
  check_attributes(cloud.attributes, cloud.points.cols(), "point cloud");
  if (cloud.width * cloud.height != cloud.points.cols())
    throw InvalidInput("point cloud: is " + std::to_string(cloud.width) + " x " +
                       std::to_string(cloud.height) + ", but has " +
                       std::to_string(cloud.points.cols()) + " points");
}

}  // namespace pcl_detail

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

/// Converts a cloud with those normals and colours that its attributes and the type of points both
/// have, as organised as before; fields without an attribute keep PCL's default.
/// \tparam Point  any of PCL's point types with x, y and z.
/// \throws InvalidInput unless width * height is the number of points, and if an attribute has not
/// one element for each point.
template <class Point>
[[nodiscard]] pcl::PointCloud<Point> to_point_cloud_of(const PointCloud& from) {
  pcl_detail::check_cloud(from);
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
    if (const auto bytes = color_bytes(from.attributes)) {
      for (Eigen::Index i = 0; i < bytes->cols(); ++i) {
        Point& point = cloud[static_cast<size_t>(i)];
        point.r = (*bytes)(0, i);
        point.g = (*bytes)(1, i);
        point.b = (*bytes)(2, i);
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

namespace pcl_detail {

// Name of the field that PCL has for one of our attributes.
inline std::string pcl_name(const std::string& name) {
  for (const char* axis : {"x", "y", "z"})
    if (name == std::string("n") + axis) return std::string("normal_") + axis;
  return name;
}

// Appends a field to the points of a cloud, whose number is known.
template <class Number>
void add_field(pcl::PCLPointCloud2& cloud, const std::string& name,
               const std::vector<Number>& values) {
  pcl::PCLPointField field;
  field.name = name;
  field.offset = cloud.point_step;
  field.datatype = pcl::traits::asEnum_v<Number>;
  field.count = 1;
  const std::size_t before = cloud.point_step, after = before + sizeof(Number);
  std::vector<std::uint8_t> data(values.size() * after);
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::copy_n(cloud.data.begin() + static_cast<std::ptrdiff_t>(i * before), before,
                data.begin() + static_cast<std::ptrdiff_t>(i * after));
    std::memcpy(&data[i * after + before], &values[i], sizeof(Number));
  }
  cloud.data = std::move(data);
  cloud.point_step = static_cast<std::uint32_t>(after);
  cloud.row_step = cloud.point_step * cloud.width;
  cloud.fields.push_back(std::move(field));
}

template <class Number>
std::vector<Number> field_values(const pcl::PCLPointCloud2& cloud,
                                 const pcl::PCLPointField& field) {
  std::vector<Number> values;
  for (std::size_t row = 0; row < cloud.height; ++row) {
    for (std::size_t column = 0; column < cloud.width; ++column) {
      const std::size_t at = row * cloud.row_step + column * cloud.point_step + field.offset;
      if (at + sizeof(Number) > cloud.data.size())
        throw InvalidInput("point cloud: its data end within field " + field.name);
      Number value;
      std::memcpy(&value, &cloud.data[at], sizeof(Number));
      values.push_back(value);
    }
  }
  return values;
}

}  // namespace pcl_detail

/// Converts a cloud with all attributes of one number, each in its type: normals become "normal_x",
/// "normal_y", "normal_z", colours "rgb" (without alpha), others keep their names. Points become
/// float.
/// \throws InvalidInput unless width * height is the number of points, and if an attribute has not
/// one element for each point.
[[nodiscard]] inline pcl::PCLPointCloud2 to_pcl_cloud2(const PointCloud& from) {
  pcl_detail::check_cloud(from);
  pcl::PCLPointCloud2 cloud;
  cloud.width = static_cast<std::uint32_t>(from.width);
  cloud.height = static_cast<std::uint32_t>(from.height);
  cloud.is_dense = from.points.allFinite();
  for (int k = 0; k < 3; ++k) {
    const Eigen::VectorXf row = from.points.row(k).transpose().cast<float>();
    pcl_detail::add_field(cloud, std::string(1, "xyz"[k]),
                          std::vector<float>(row.begin(), row.end()));
  }
  if (const auto bytes = color_bytes(from.attributes)) {
    std::vector<std::uint32_t> packed;
    for (const auto& color : bytes->colwise())
      packed.push_back(std::uint32_t{color[0]} << 16U | std::uint32_t{color[1]} << 8U | color[2]);
    std::vector<float> bits(packed.size());  // PCL's readers expect this type
    if (!bits.empty()) std::memcpy(bits.data(), packed.data(), 4 * packed.size());
    pcl_detail::add_field(cloud, "rgb", bits);
  }
  for (const Attribute& attribute : from.attributes) {
    if (!attribute.list_sizes.empty() || attribute.name == "red" || attribute.name == "green" ||
        attribute.name == "blue" || attribute.name == "alpha")
      continue;
    std::visit(
        [&](const auto& values) {
          const std::string name = pcl_detail::pcl_name(attribute.name);
          if (name == attribute.name) return pcl_detail::add_field(cloud, name, values);
          pcl_detail::add_field(cloud, name, std::vector<float>(values.begin(), values.end()));
        },
        attribute.values);
  }
  return cloud;
}

/// Converts a cloud with all fields of one number; the inverse of `to_pcl_cloud2`. The alpha of
/// "rgba" is kept.
/// \throws InvalidInput naming what is missing: x, y or z, or data within a field.
[[nodiscard]] inline PointCloud from_pcl_cloud2(const pcl::PCLPointCloud2& from) {
  PointCloud cloud;
  cloud.width = from.width;
  cloud.height = from.height;
  cloud.points.resize(3, cloud.width * cloud.height);
  std::string missing = "xyz";
  for (const pcl::PCLPointField& field : from.fields) {
    if (field.count != 1) continue;
    if (field.name == "rgb" || field.name == "rgba") {
      Eigen::Matrix4Xd rgba(4, cloud.points.cols());
      Eigen::Index i = 0;
      for (const std::uint32_t packed : pcl_detail::field_values<std::uint32_t>(from, field))
        rgba.col(i++) << (packed >> 16U & 255U), (packed >> 8U & 255U), (packed & 255U),
            (packed >> 24U);
      set_colors(cloud.attributes, rgba.topRows(field.name == "rgb" ? 3 : 4) / 255);
      continue;
    }
    const auto take = [&]<class Number>(std::type_identity<std::vector<Number>>) {
      if (field.datatype != pcl::traits::asEnum_v<Number>) return;
      std::vector<Number> values = pcl_detail::field_values<Number>(from, field);
      if (const std::size_t axis = std::string("xyz").find(field.name);
          field.name.size() == 1 && axis != std::string::npos) {
        for (Eigen::Index i = 0; i < cloud.points.cols(); ++i)
          cloud.points(static_cast<Eigen::Index>(axis), i) =
              static_cast<double>(values[static_cast<std::size_t>(i)]);
        std::erase(missing, field.name[0]);
        return;
      }
      std::string name = field.name;
      for (const char* own : {"nx", "ny", "nz"})
        if (pcl_detail::pcl_name(own) == field.name) name = own;
      set_attribute(cloud.attributes,
                    {.name = name, .values = std::move(values), .list_sizes = {}});
    };
    const auto each = [&]<class... Lists>(std::type_identity<std::variant<Lists...>>) {
      (take(std::type_identity<Lists>()), ...);
    };
    each(std::type_identity<AttributeValues>());
  }
  if (!missing.empty()) throw InvalidInput(std::string("point cloud: has no field ") + missing[0]);
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

/// Converts a mesh with the attributes of its vertices, as `to_pcl_cloud2`.
/// \throws InvalidInput if the mesh is not valid or an attribute has not one element for each
/// vertex.
[[nodiscard]] inline pcl::PolygonMesh to_polygon_mesh(const MeshFile& file) {
  pcl::PolygonMesh polygons = to_polygon_mesh(file.mesh);
  PointCloud cloud;
  cloud.points = file.mesh.vertices;
  cloud.width = cloud.points.cols();
  cloud.attributes = file.vertex_attributes;
  polygons.cloud = to_pcl_cloud2(cloud);
  return polygons;
}

/// Converts a mesh with the fields of its vertices, as `from_pcl_cloud2`.
/// \throws InvalidInput as `from_polygon_mesh` and `from_pcl_cloud2`.
[[nodiscard]] inline MeshFile mesh_file_of(const pcl::PolygonMesh& polygons) {
  MeshFile file;
  file.mesh = from_polygon_mesh(polygons);
  file.vertex_attributes = from_pcl_cloud2(polygons.cloud).attributes;
  return file;
}

}  // namespace palpate::geometry
