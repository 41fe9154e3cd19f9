// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/model.h"

#include <Eigen/LU>
#include <cmath>

#include "palpate/error.h"

namespace palpate::haptics {
namespace {

bool is_rotation(const Eigen::Matrix3d& matrix) {
  const Eigen::Matrix3d product = matrix.transpose() * matrix;
  return (product - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <= kFrameTolerance &&
         matrix.determinant() > 0;
}

void check_contact(const ContactModel& contact, const std::string& name) {
  if (!contact.position.allFinite()) throw InvalidInput(name + ": its position is not finite");
  if (!is_rotation(contact.frame)) {
    throw InvalidInput(name + ": its frame must hold three orthogonal unit axes, right-handed");
  }
  if (!(std::abs(contact.friction_axis.norm() - 1) <= kFrameTolerance)) {
    throw InvalidInput(name + ": its friction axis must be a unit vector");
  }
  if (!(contact.friction >= 0) || !std::isfinite(contact.friction)) {
    throw InvalidInput(name + ": its friction coefficient is " + std::to_string(contact.friction) +
                       "; it must be finite and >= 0");
  }
  check_force_field(contact.field, name.c_str());
}

}  // namespace

void check_model(const Model& model) {
  geometry::check_mesh(model.surface, "the model's surface");
  if (model.contacts.size() < 3) {
    throw InvalidInput("the model has " + std::to_string(model.contacts.size()) +
                       " contacts; at least three are needed");
  }
  for (std::size_t i = 0; i < model.contacts.size(); ++i) {
    check_contact(model.contacts[i], "contact " + std::to_string(model.contacts[i].id) +
                                         " (entry " + std::to_string(i) + ")");
  }
  geometry::check_mesh(contact_mesh(model), "the model's triangles of contacts");
  if (!is_rotation(model.T_surface_acquisition.linear()) ||
      !model.T_surface_acquisition.translation().allFinite()) {
    throw InvalidInput("the model's registration must be a rotation and a finite translation");
  }
}

geometry::TriangleMesh contact_mesh(const Model& model) {
  geometry::TriangleMesh mesh;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(model.contacts.size()));
  for (std::size_t i = 0; i < model.contacts.size(); ++i) {
    mesh.vertices.col(static_cast<Eigen::Index>(i)) = model.contacts[i].position;
  }
  mesh.triangles = model.triangles;
  return mesh;
}

}  // namespace palpate::haptics
