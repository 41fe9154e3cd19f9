// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CGAL/Point_set_3.h>

#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "palpate/geometry/cgal_properties.h"

/// \file
/// Conversion to and from CGAL's Point_set_3, which is under the GPL. Normals are those of the
/// point set; each other attribute is a property map of its name and type of numbers, so that
/// colours are "red", "green" and "blue", as CGAL's readers name them. Attributes with lists are
/// left out.
namespace palpate::geometry {

/// Converts the points that are finite, with their attributes.
/// \throws InvalidInput if an attribute has not one element for each point.
template <class Point>
[[nodiscard]] CGAL::Point_set_3<Point> to_point_set(const PointCloud& cloud) {
  using Set = CGAL::Point_set_3<Point>;
  check_attributes(cloud.attributes, cloud.points.cols(), "point cloud");
  Set set;
  std::vector<std::pair<Eigen::Index, typename Set::Index>> known;
  for (Eigen::Index i = 0; i < cloud.points.cols(); ++i) {
    const Eigen::Vector3d p = cloud.points.col(i);
    if (p.allFinite()) known.emplace_back(i, *set.insert(Point(p.x(), p.y(), p.z())));
  }
  if (const auto found = normals(cloud.attributes)) {
    set.add_normal_map();
    for (const auto& [i, index] : known) {
      const Eigen::Vector3d n = found->col(i);
      set.normal(index) = typename Set::Vector_3(n.x(), n.y(), n.z());
    }
  }
  for (const Attribute& attribute : cloud.attributes) {
    if (!attribute.list_sizes.empty() || cgal_detail::is_one_of(attribute.name, {"nx", "ny", "nz"}))
      continue;
    std::visit(
        [&](const auto& values) {
          using Number = typename std::decay_t<decltype(values)>::value_type;
          auto map = set.template add_property_map<Number>(attribute.name).first;
          for (const auto& [i, index] : known) map[index] = values[static_cast<std::size_t>(i)];
        },
        attribute.values);
  }
  return set;
}

/// Converts a point set with its normals and property maps of numbers; the points that are not
/// removed, in their order.
template <class Point>
[[nodiscard]] PointCloud from_point_set(const CGAL::Point_set_3<Point>& set) {
  PointCloud cloud;
  const auto count = static_cast<Eigen::Index>(set.size());
  cloud.width = count;
  cloud.points.resize(3, count);
  Eigen::Index i = 0;
  for (const auto& index : set) cloud.points.col(i++) = cgal_detail::to_eigen(set.point(index));
  if (set.has_normal_map()) {
    Eigen::Matrix3Xd normals(3, count);
    i = 0;
    for (const auto& index : set) normals.col(i++) = cgal_detail::to_eigen(set.normal(index));
    set_normals(cloud.attributes, normals);
  }
  for (const std::string& name : set.properties()) {
    cgal_detail::for_each_number_type([&]<class Number>(Number) {
      const auto found = set.template property_map<Number>(name);
      if (!cgal_detail::is_found(found)) return;
      std::vector<Number> values;
      for (const auto& index : set) values.push_back(cgal_detail::map_in(found)[index]);
      set_attribute(cloud.attributes,
                    {.name = name, .values = std::move(values), .list_sizes = {}});
    });
  }
  return cloud;
}

}  // namespace palpate::geometry
