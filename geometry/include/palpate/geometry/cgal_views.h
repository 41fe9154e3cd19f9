// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CGAL/Kernel_traits.h>

#include <Eigen/Core>
#include <type_traits>

#include "palpate/geometry/eigen_alignment.h"

/// \file
/// Property maps of CGAL's Surface_mesh and Point_set_3 as Eigen matrices, without a copy: points,
/// normals and numbers. Triangles have no such view: CGAL stores halfedges.
///
///     Eigen::VectorXd d = distances_to_surface(columns_of(surface.points()), other);
///     values_of(surface.add_property_map<Vertex, double>("v:distance").first) = d;
///
/// A view has one column or element for each index of CGAL, also those of elements that are
/// removed: collect the garbage first. Writing to it writes to the map. It is valid until elements
/// are added or the garbage is collected.
namespace palpate::geometry {

/// Points or vectors as a 3 x N matrix.
/// \tparam Map  property map of points or vectors of a kernel that stores three doubles, such as
/// Simple_cartesian<double> and Exact_predicates_inexact_constructions_kernel.
template <class Map>
[[nodiscard]] auto columns_of(Map map) {
  using Point = typename Map::value_type;
  using Number = typename CGAL::Kernel_traits<Point>::Kernel::FT;
  static_assert(std::is_same_v<Number, double> && sizeof(Point) == 3 * sizeof(double) &&
                    std::is_standard_layout_v<Point>,
                "the kernel does not store points as three doubles: convert the mesh");
  const auto count = static_cast<Eigen::Index>(map.end() - map.begin());
  // The only member of a point is its array of coordinates.
  auto* const first = count == 0 ? nullptr : reinterpret_cast<double*>(&*map.begin());
  return Eigen::Map<Eigen::Matrix3Xd>(first, 3, count);
}

/// Numbers as a vector.
template <class Map>
[[nodiscard]] auto values_of(Map map) {
  using Number = typename Map::value_type;
  static_assert(std::is_arithmetic_v<Number> && !std::is_same_v<Number, bool>);
  const auto count = static_cast<Eigen::Index>(map.end() - map.begin());
  return Eigen::Map<Eigen::Vector<Number, Eigen::Dynamic>>(count == 0 ? nullptr : &*map.begin(),
                                                           count);
}

}  // namespace palpate::geometry
