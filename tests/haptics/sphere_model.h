// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

#include "haptics_testing.h"
#include "palpate/geometry/contact_triangulation.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/haptics/model.h"
#include "palpate/haptics/rotation.h"
#include "test_surfaces.h"

namespace palpate::haptics {

constexpr double kSphereRadius = 40;  // [mm]

/// Evenly spread places on the sphere about the origin.
inline std::vector<Eigen::Vector3d> places_on_sphere(int count) {
  std::vector<Eigen::Vector3d> places;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count;
    const double angle = 2 * std::numbers::pi * std::numbers::phi * i;
    const double r = std::sqrt(1 - z * z);
    places.emplace_back(kSphereRadius *
                        Eigen::Vector3d(r * std::cos(angle), r * std::sin(angle), z));
  }
  return places;
}

/// The field at a place of a ball that is harder above than below: stiffer into it than along it,
/// the same in all directions along it. In a frame whose z axis points inwards.
inline ForceField ball_field(const Eigen::Vector3d& place) {
  const double height = place.z() / kSphereRadius;
  return {{{.weight = 4 + height, .epsilon = 9},
           {.weight = 3 + 2 * height, .epsilon = 7, .ridge = Eigen::Vector3d::UnitZ()}}};
}

/// The force there in the world.
inline Eigen::Vector3d ball_force(const Eigen::Vector3d& place,
                                  const Eigen::Vector3d& displacement) {
  const Eigen::Matrix3d frame = rotation_between(Eigen::Vector3d::UnitZ(), -place);
  return frame * force(ball_field(place), frame.transpose() * displacement);
}

/// Turns that have nothing to do with those of neighbours.
inline double uneven_twist(int i) { return 2.4 * i * i; }

/// A model of the part of the ball whose triangles `covers` wants, with those of the contacts that
/// lie on it. Contact i has id i, and a frame that is turned about its axis by `twist(i)`. The ball
/// has 20 * 4^levels triangles.
inline Model ball_model(
    const std::function<bool(const Eigen::Vector3d& centroid)>& covers,
    const std::function<double(int)>& twist = [](int) { return 0.0; }, int contacts = 120,
    int levels = 4) {
  Model model;
  const geometry::TriangleMesh ball = geometry::test::icosphere(levels, kSphereRadius);
  model.surface.vertices = ball.vertices;
  model.surface.triangles.resize(3, ball.triangles.cols());
  Eigen::Index kept = 0;
  for (const auto& t : ball.triangles.colwise()) {
    const Eigen::Vector3d centroid = ball.vertices(Eigen::all, t).rowwise().mean();
    if (covers(centroid)) model.surface.triangles.col(kept++) = t;
  }
  model.surface.triangles.conservativeResize(3, kept);
  const geometry::SurfaceQuery whole(ball), query(model.surface);
  std::vector<geometry::SurfacePoint> points;
  const std::vector<Eigen::Vector3d> places = places_on_sphere(contacts);
  for (int i = 0; i < contacts; ++i) {
    const Eigen::Vector3d& place = places[static_cast<std::size_t>(i)];
    const geometry::ClosestPoint on_surface =
        query.closest_point(whole.closest_point(place).position);
    if (on_surface.distance > 1e-9 * kSphereRadius) continue;  // not on this part
    ContactModel contact;
    contact.id = i;
    contact.position = on_surface.position;
    contact.frame =
        rotation_between(Eigen::Vector3d::UnitZ(), -place) * rotation_exp({0, 0, twist(i)});
    contact.field = ball_field(place);
    contact.friction = 0.5;
    contact.friction_axis = -place.normalized();
    contact.samples = 10;
    contact.rms = 0.01;
    model.contacts.push_back(contact);
    points.push_back(on_surface.at);
  }
  geometry::ContactTriangulation triangulation =
      geometry::triangulate_contacts(model.surface, points);
  model.triangles = std::move(triangulation.mesh.triangles);
  model.surface_weights = std::move(triangulation.weights);
  return model;
}

}  // namespace palpate::haptics
