// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <vector>

#include "palpate/haptics/fit_surface_response.h"
#include "sheet_model.h"

namespace palpate::haptics {

/// A sheet that follows the tool in a known way: the dent around a place is wider the farther it is
/// from the left border, and half as deep sideways.
inline Eigen::Matrix3Xd true_shape(const geometry::TriangleMesh& sheet,
                                   const Eigen::Vector3d& place,
                                   const Eigen::Vector3d& displacement) {
  const double width = 18 + 0.1 * place.x();  // [mm]
  Eigen::Matrix3Xd shape = sheet.vertices;
  for (Eigen::Index v = 0; v < shape.cols(); ++v) {
    const double d = (sheet.vertices.col(v) - place).norm() / width;
    shape.col(v) += std::exp(-d * d) * displacement;
  }
  return shape;
}

/// The sheet model on a fine mesh, and shapes of three displacements at each contact.
struct FollowingSheet {
  Model model = sheet_model();
  std::vector<RecordedShape> shapes;

  FollowingSheet() {
    model.surface = flat_surface(50, 40);
    for (std::size_t c = 0; c < model.contacts.size(); ++c) {
      for (const Eigen::Vector3d& displacement :
           {Eigen::Vector3d(0, 0, 6), Eigen::Vector3d(2, 0, 5), Eigen::Vector3d(-1, 2, 8)}) {
        shapes.push_back(
            {c, displacement, true_shape(model.surface, model.contacts[c].position, displacement)});
      }
    }
  }

  [[nodiscard]] SurfaceResponse fit(const SurfaceResponseOptions& options = {}) const {
    return fit_surface_response(
        model, shapes.size(), [&](std::size_t k) { return shapes[k]; }, options);
  }
};

}  // namespace palpate::haptics
