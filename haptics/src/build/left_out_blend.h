// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "model/compliance_kriging.h"
#include "palpate/haptics/blended_field.h"

namespace palpate::haptics {

/// Predicts each contact of a model from those around it as the model would without it, in a time
/// that does not depend on the number of contacts: without another triangulation, and with the
/// covariance of all contacts together.
class LeftOutBlends {
 public:
  /// \param model must outlive this.
  explicit LeftOutBlends(const Model& model);

  /// The blend at a contact as the others give it: of the corners of their Delaunay triangle around
  /// it, in its tangent plane; at the border, of the nearest edge or contact. Nothing if there are
  /// no others around it.
  [[nodiscard]] std::optional<Blend> at(std::size_t contact) const;

  /// For each contact, those around it.
  [[nodiscard]] const std::vector<std::vector<int>>& neighbours() const {
    return kriging_.neighbours;
  }

 private:
  // Returns the model of a corner, with the trend that it has without the contact.
  [[nodiscard]] ContactModel corner_without(int corner, std::size_t contact) const;

  const Model& model_;
  ComplianceKriging kriging_;
  std::vector<int> known_;  // index in `kriging_` of each contact, or -1
};

}  // namespace palpate::haptics
