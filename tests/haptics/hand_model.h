// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "height_field_model.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/triangle_mesh.h"
#include "palpate/haptics/model.h"
#include "palpate/haptics/rotation.h"
#include "repository.h"

namespace palpate::haptics {

/// The hand that a depth camera saw, with 40 contacts of the same bases.
/// \param friction of contact i.
template <typename Friction>
Model hand_model(Friction friction) {
  Model model;
  model.surface = geometry::read_mesh(palpate::repository("meshes") / "hand.ply");
  const Eigen::Matrix3Xd normals = geometry::triangle_normals(model.surface);
  std::vector<geometry::SurfacePoint> places;
  constexpr int kContacts = 40;
  for (int i = 0; i < kContacts; ++i) {
    const int triangle = static_cast<int>(model.surface.triangles.cols()) / kContacts * i;
    const geometry::SurfacePoint place{triangle, Eigen::Vector3d::Constant(1.0 / 3)};
    ContactModel contact;
    contact.id = i;
    contact.position = geometry::position(model.surface, place);
    contact.frame = rotation_between(Eigen::Vector3d::UnitZ(), -normals.col(triangle));
    contact.field = six_bases(0.6, 0, 0);
    contact.friction = friction(i);
    contact.friction_axis = -normals.col(triangle);
    contact.samples = 10;
    model.contacts.push_back(contact);
    places.push_back(place);
  }
  return with_triangles(std::move(model), places);
}

}  // namespace palpate::haptics
