// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "haptics_testing.h"
#include "palpate/geometry/contact_triangulation.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/haptics/model.h"
#include "palpate/haptics/rotation.h"

namespace palpate::haptics {

inline const Eigen::Vector3d kDisplacement(1, -2, 3);
/// [N] of forces of up to some 30 N, in numbers of `kFieldDigits` digits.
inline constexpr double kForceRounding = 1e-5;

/// A flat square of the given half size at z = 700, its outside towards -z, in `cells` x `cells`
/// squares.
inline geometry::TriangleMesh flat_surface(double half_size = 50, int cells = 10) {
  geometry::TriangleMesh mesh;
  const int side = cells + 1;
  mesh.vertices.resize(3, side * side);
  for (int i = 0; i < side * side; ++i) {
    mesh.vertices.col(i) << (2.0 * (i % side) / cells - 1) * half_size,
        (2.0 * (i / side) / cells - 1) * half_size, 700;
  }
  mesh.triangles.resize(3, 2 * cells * cells);
  for (int i = 0; i < cells * cells; ++i) {
    const int corner = i / cells * side + i % cells;
    mesh.triangles.col(2 * i) << corner, corner + side, corner + 1;
    mesh.triangles.col(2 * i + 1) << corner + 1, corner + side, corner + side + 1;
  }
  return mesh;
}

/// The flat surface with contacts on a grid of this spacing [mm], with the fields of their places.
inline Model grid_model(double spacing,
                        const std::function<ForceField(double x, double y)>& field) {
  Model model;
  model.surface = flat_surface();
  std::vector<geometry::SurfacePoint> points;
  const geometry::SurfaceQuery query(model.surface);
  for (double y = -42; y <= 42; y += spacing) {
    for (double x = -42; x <= 42; x += spacing) {
      ContactModel contact;
      contact.id = static_cast<long long>(model.contacts.size());
      contact.position << x, y, 700;
      contact.field = field(x, y);
      points.push_back(query.closest_point(contact.position).at);
      model.contacts.push_back(contact);
    }
  }
  geometry::ContactTriangulation found = geometry::triangulate_contacts(model.surface, points);
  model.triangles = found.mesh.triangles;
  model.surface_weights = found.weights;
  return model;
}

/// The flat surface with four contacts at (+-30, +-30). Each field is one centred base, so that the
/// force is along the displacement: f = weight d / sqrt(d^2 + epsilon^2), the same in every frame.
/// The friction axis is the inward normal; frames differ by turns about it.
inline Model sheet_model(double friction = 0.5) {
  Model model;
  model.surface = flat_surface();
  for (int i = 0; i < 4; ++i) {
    ContactModel contact;
    contact.id = 10 + i;
    contact.position << (i % 2 ? 30 : -30), (i / 2 ? 30 : -30), 700;
    contact.frame = rotation_exp({0, 0, 0.1 * i});
    contact.field = spring(4, 10);
    contact.friction = friction;
    contact.friction_source = FrictionSource::samples;
    contact.samples = 100 + i;
    contact.rms = 0.01 * i;
    contact.fit_stop = FitStop::accurate;
    model.contacts.push_back(contact);
  }
  model.triangles.resize(3, 2);
  model.triangles << 0, 1,  //
      2, 2,                 //
      1, 3;
  model.made = {{"source", "a \"test\""}};
  return model;
}

/// A model with different fields, tilted frames and friction at its contacts.
inline Model uneven_model() {
  Model model = sheet_model();
  for (std::size_t i = 0; i < 4; ++i) {
    ContactModel& contact = model.contacts[i];
    contact.field = scaled(some_field_with_ridge(), 1 + 0.3 * static_cast<double>(i));
    contact.frame =
        rotation_exp({0.05 * static_cast<double>(i), -0.04, 0.2 / 3 * static_cast<double>(i)});
    contact.friction = (4 + static_cast<double>(i)) / 10;
    contact.friction_axis = contact.frame * Eigen::Vector3d(0.1, 0.2, 1).normalized();
  }
  return model;
}

/// The same object elsewhere in the world.
inline Model moved(Model model, const Eigen::Isometry3d& motion) {
  model.surface.vertices = motion * model.surface.vertices;
  for (ContactModel& contact : model.contacts) {
    contact.position = motion * contact.position;
    contact.frame = motion.linear() * contact.frame;
    contact.friction_axis = motion.linear() * contact.friction_axis;
  }
  return model;
}

inline Eigen::Isometry3d some_motion() {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.linear() = some_rotation();
  motion.translation() << 12.3, -45.6, 78.9;
  return motion;
}

}  // namespace palpate::haptics
