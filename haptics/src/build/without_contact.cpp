// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "build/without_contact.h"

#include <utility>

namespace palpate::haptics {

Model without_contact(const Model& model, const geometry::LeftOutTriangulations& triangulations,
                      std::size_t contact) {
  geometry::ContactTriangulation triangulation = triangulations.without(contact);
  Model rest = model;
  rest.contacts.erase(rest.contacts.begin() + static_cast<std::ptrdiff_t>(contact));
  rest.triangles = std::move(triangulation.mesh.triangles);
  rest.surface_weights = std::move(triangulation.weights);
  rest.response.reset();
  return rest;
}

}  // namespace palpate::haptics
