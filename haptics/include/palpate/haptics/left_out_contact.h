// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "palpate/geometry/left_out_triangulations.h"
#include "palpate/geometry/triangle_mesh.h"
#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// The models of all contacts but one (thesis 5.3.3). The others are triangulated by the method
/// that the model was made with (see `geometry::LeftOutTriangulations`), and their compliances are
/// computed again. Thread-safe.
class LeftOutModels {
 public:
  /// \param model with at least four contacts; must outlive this.
  /// \param points of all contacts of the model on its surface
  /// \throws InvalidInput if there is not one point for each contact, or if they cannot be
  /// triangulated.
  LeftOutModels(const Model& model, std::span<const geometry::SurfacePoint> points);

  /// The model without one contact, of this index, and without `Model::response`, which belongs to
  /// all contacts.
  /// \throws InvalidInput if there is no such contact, or if the others cannot be triangulated.
  [[nodiscard]] Model without(std::size_t contact) const;

 private:
  const Model& model_;
  geometry::LeftOutTriangulations triangulations_;
};

/// Marks the contacts at the border of the triangulation of contacts: on an edge of one triangle
/// only. In the order of the model's contacts.
[[nodiscard]] std::vector<bool> border_contacts(const Model& model);

}  // namespace palpate::haptics
