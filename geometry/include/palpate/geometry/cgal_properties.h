// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CGAL/IO/Color.h>
#include <CGAL/Kernel_traits.h>

#include <algorithm>
#include <initializer_list>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "palpate/geometry/attribute.h"
#include "palpate/geometry/cgal_mesh.h"
#include "palpate/geometry/mesh_io.h"

/// \file
/// Attributes as property maps of CGAL's Surface_mesh, both ways.
///
/// Names are those of CGAL's readers: "v:normal" and "f:normal" of the kernel's vectors, "v:color"
/// and "f:color" of CGAL::IO::Color, and for each other attribute "v:NAME" or "f:NAME" of its type
/// of numbers. CGAL's colours always have an alpha. Attributes with lists are left out.
namespace palpate::geometry {
namespace cgal_detail {

/// A map of a mesh; CGAL before 6 gives it with a flag, later versions as an optional.
template <class Found>
bool is_found(const Found& found) {
  if constexpr (requires { found.second; }) {
    return found.second;
  } else {
    return found.has_value();
  }
}
template <class Found>
auto map_in(const Found& found) {
  if constexpr (requires { found.second; }) {
    return found.first;
  } else {
    return *found;
  }
}

inline bool is_one_of(std::string_view name, std::initializer_list<std::string_view> names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

template <class Vector>
Eigen::Vector3d to_eigen(const Vector& v) {
  return {CGAL::to_double(v.x()), CGAL::to_double(v.y()), CGAL::to_double(v.z())};
}

/// Calls `action` with a value of each type of numbers that an attribute may have.
template <class Action>
void for_each_number_type(const Action& action) {
  const auto each = [&]<class... Values>(std::type_identity<std::variant<Values...>>) {
    (action(typename Values::value_type()), ...);
  };
  each(std::type_identity<AttributeValues>());
}

template <class Index, class Surface>
void add_properties(const Attributes& attributes, const std::string& prefix, Surface& surface) {
  using Vector = typename CGAL::Kernel_traits<typename Surface::Point>::Kernel::Vector_3;
  const auto at = [](auto i) { return Index(static_cast<typename Surface::size_type>(i)); };
  if (const auto found = normals(attributes)) {
    auto map = surface.template add_property_map<Index, Vector>(prefix + "normal").first;
    for (Eigen::Index i = 0; i < found->cols(); ++i)
      map[at(i)] = Vector((*found)(0, i), (*found)(1, i), (*found)(2, i));
  }
  if (const auto bytes = color_bytes(attributes)) {
    auto map = surface.template add_property_map<Index, CGAL::IO::Color>(prefix + "color").first;
    for (Eigen::Index i = 0; i < bytes->cols(); ++i) {
      const auto color = bytes->col(i);
      map[at(i)] = CGAL::IO::Color(color[0], color[1], color[2], color[3]);
    }
  }
  for (const Attribute& attribute : attributes) {
    if (!attribute.list_sizes.empty() ||
        is_one_of(attribute.name, {"nx", "ny", "nz", "red", "green", "blue", "alpha"}))
      continue;
    std::visit(
        [&](const auto& values) {
          using Number = typename std::decay_t<decltype(values)>::value_type;
          auto map =
              surface.template add_property_map<Index, Number>(prefix + attribute.name).first;
          for (std::size_t i = 0; i < values.size(); ++i) map[at(i)] = values[i];
        },
        attribute.values);
  }
}

/// \param elements  vertices or faces, without removed ones
template <class Index, class Surface, class Elements>
Attributes properties_of(const Surface& surface, const std::string& prefix,
                         const Elements& elements) {
  using Vector = typename CGAL::Kernel_traits<typename Surface::Point>::Kernel::Vector_3;
  Attributes attributes;
  const std::vector<Index> all(elements.begin(), elements.end());
  const auto count = static_cast<Eigen::Index>(all.size());
  if (const auto found = surface.template property_map<Index, Vector>(prefix + "normal");
      is_found(found)) {
    Eigen::Matrix3Xd normals(3, count);
    for (Eigen::Index i = 0; i < count; ++i)
      normals.col(i) = to_eigen(map_in(found)[all[static_cast<std::size_t>(i)]]);
    set_normals(attributes, normals);
  }
  if (const auto found = surface.template property_map<Index, CGAL::IO::Color>(prefix + "color");
      is_found(found)) {
    Eigen::Matrix4Xd colors(4, count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const CGAL::IO::Color& color = map_in(found)[all[static_cast<std::size_t>(i)]];
      for (int k = 0; k < 4; ++k) colors(k, i) = color[static_cast<std::size_t>(k)] / 255.0;
    }
    set_colors(attributes, colors);
  }
  for (const std::string& name : surface.template properties<Index>()) {
    if (!name.starts_with(prefix)) continue;
    for_each_number_type([&]<class Number>(Number) {
      const auto found = surface.template property_map<Index, Number>(name);
      if (!is_found(found)) return;
      std::vector<Number> values;
      for (const Index element : all) values.push_back(map_in(found)[element]);
      set_attribute(
          attributes,
          {.name = name.substr(prefix.size()), .values = std::move(values), .list_sizes = {}});
    });
  }
  return attributes;
}

}  // namespace cgal_detail

/// Converts a mesh with its attributes.
/// \throws InvalidInput as for a mesh alone.
template <class Point>
[[nodiscard]] CGAL::Surface_mesh<Point> to_surface_mesh(const MeshFile& file) {
  using Surface = CGAL::Surface_mesh<Point>;
  check_attributes(file.vertex_attributes, file.mesh.vertices.cols(), "vertex attributes");
  check_attributes(file.triangle_attributes, file.mesh.triangles.cols(), "triangle attributes");
  Surface surface = to_surface_mesh<Point>(file.mesh);
  cgal_detail::add_properties<typename Surface::Vertex_index>(file.vertex_attributes,
                                                              "v:", surface);
  cgal_detail::add_properties<typename Surface::Face_index>(file.triangle_attributes,
                                                            "f:", surface);
  return surface;
}

/// Converts a mesh with its property maps.
/// \throws InvalidInput as `from_surface_mesh`.
template <class Point>
[[nodiscard]] MeshFile mesh_file_of(const CGAL::Surface_mesh<Point>& surface) {
  using Surface = CGAL::Surface_mesh<Point>;
  MeshFile file;
  file.mesh = from_surface_mesh(surface);
  file.vertex_attributes =
      cgal_detail::properties_of<typename Surface::Vertex_index>(surface, "v:", surface.vertices());
  file.triangle_attributes =
      cgal_detail::properties_of<typename Surface::Face_index>(surface, "f:", surface.faces());
  return file;
}

}  // namespace palpate::geometry
