// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "palpate/geometry/contact_triangulation.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/haptics/contact_compliance.h"
#include "palpate/haptics/force_field.h"
#include "palpate/haptics/model.h"
#include "palpate/haptics/rotation.h"
#include "test_surfaces.h"

namespace palpate::haptics {

using Height = std::function<double(double x, double y)>;

struct HeightFieldObject {
  Height height;
  double friction = 0.5;
  bool uneven = false;    ///< fields, friction and cones differ from place to place
  double half_size = 30;  ///< [mm] of the square
  int cells = 60;         ///< along each side; even, so that x = 0 is along edges
  int grid = 7;           ///< contacts along each side
};

/// Six convex bases, the same kinds at every place: softening, stiffening, and ridges.
inline ForceField six_bases(double scale, double along, double across) {
  using Eigen::Vector3d;
  return {{{4.0 * scale, 8.0},
           {2.0 * scale, 3.0, {0, 0, 9 + along}},
           {1.5 * scale, 5.0, {0.9 * along, 0.8 * across, 4}},
           {1.2 * scale, 4.0, {0, 0, 6}, Vector3d(0.2 * along, 0.1 * across, 1).normalized()},
           {0.8 * scale, 3.5, {2, 0, 2}, Vector3d(1, 0.15 * across, 0.2).normalized()},
           {0.7 * scale, 3.5, {0, -2, 2}, Vector3d(0.1 * along, 1, -0.2).normalized()}}};
}

/// Joins the contacts, which stand at these places, to triangles, and blends them by compliances.
inline Model with_triangles(Model model, std::span<const geometry::SurfacePoint> places) {
  geometry::ContactTriangulation triangulation =
      geometry::triangulate_contacts(model.surface, places);
  model.triangles = std::move(triangulation.mesh.triangles);
  model.surface_weights = std::move(triangulation.weights);
  return with_compliances(std::move(model), 1);
}

/// An object below z = height(x, y) that is felt from above, blended by compliances.
inline Model height_field_model(const HeightFieldObject& object) {
  Model model;
  const double half = object.half_size;
  model.surface = geometry::test::height_field(
      object.cells, object.cells, 2 * half / object.cells,
      [&](double x, double y) { return object.height(x - half, y - half); });
  model.surface.vertices.topRows<2>().array() -= half;
  const geometry::SurfaceQuery query(model.surface);
  std::vector<geometry::SurfacePoint> places;
  for (int i = 0; i < object.grid * object.grid; ++i) {
    // 0.92: no contact on the border; 0.013, 0.017: none on an edge of the mesh.
    const double step = 2 * 0.92 * half / (object.grid - 1);
    const double x = i % object.grid * step - 0.92 * half + 0.013,
                 y = i / object.grid * step - 0.92 * half + 0.017;
    const geometry::ClosestPoint at = query.closest_point({x, y, object.height(x, y)});
    constexpr double kStep = 1;  // [mm] of central differences
    const double slope_x = object.height(x + kStep, y) - object.height(x - kStep, y),
                 slope_y = object.height(x, y + kStep) - object.height(x, y - kStep);
    const Eigen::Vector3d inward = Eigen::Vector3d(slope_x, slope_y, -2 * kStep).normalized();
    ContactModel contact;
    contact.id = i;
    contact.position = at.position;
    contact.frame = rotation_between(Eigen::Vector3d::UnitZ(), inward);
    contact.field = six_bases(0.6, 0, 0);
    contact.friction = object.friction;
    contact.friction_axis = inward;
    if (object.uneven) {
      contact.field = six_bases(0.6 + 0.35 * std::sin(x / 7) * std::cos(y / 5.5),
                                std::sin(x / 9 + 0.3), std::cos(y / 8 - 0.2));
      contact.frame = contact.frame * rotation_exp({0.07 * std::sin(x / 9), 0.07 * std::cos(y / 12),
                                                    0.2 * std::sin(x / 15)});
      contact.friction *= 1 + 0.3 * std::sin(x / 10) * std::cos(y / 15);
      contact.friction_axis = (inward + 0.1 * contact.frame.col(0) * std::sin(x / 7) +
                               0.1 * contact.frame.col(1) * std::cos(y / 6.5))
                                  .normalized();
    }
    contact.samples = 100;
    model.contacts.push_back(contact);
    places.push_back(at.at);
  }
  return with_triangles(std::move(model), places);
}

/// Gentle waves.
inline double waves(double x, double y) {
  return 3 * std::sin(x / 6.4) * std::cos(y / 4.8) + 0.5 * std::sin((x + 0.6 * y) / 2);
}

}  // namespace palpate::haptics
