// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "palpate/haptics/blended_field.h"
#include "palpate/haptics/force_field.h"
#include "sheet_model.h"

namespace palpate::haptics {

/// Stiffness of the flat object at a place over that far away: a hump as wide as a few contacts.
inline double hump_stiffness(double x, double y) {
  return 1 + 3 * std::exp(-(x * x + y * y) / 500);
}

/// One shape of field everywhere, which stiffens with the depth.
inline ForceField hump_field(double x, double y) {
  const double scale = hump_stiffness(x, y);
  return {{{0.8 * scale, 12.0}, {0.5 * scale, 3.0, {0, 0, 8}}}};
}

inline Model hump_model(double spacing) { return grid_model(spacing, hump_field); }

/// [N] the largest error of the forces of a model, mostly between its contacts. A similarity
/// `pose` has moved the object, and scaled it as its material would.
inline double worst_error_of_hump(const Model& model,
                                  const Eigen::Affine3d& pose = Eigen::Affine3d::Identity()) {
  const BlendedField field(model);
  const double scale = std::cbrt(pose.linear().determinant());
  double worst = 0;
  for (double x = -40; x <= 40; x += 3.1) {
    const double y = 0.4 * x + 1;
    for (const Eigen::Vector3d& d : {Eigen::Vector3d(0, 0, 8), Eigen::Vector3d(2, -1, 4)}) {
      const Eigen::Vector3d truth = scale * pose.linear() * force(hump_field(x, y), d);
      const Eigen::Vector3d is = field.force(pose * Eigen::Vector3d(x, y, 700), pose.linear() * d);
      worst = std::max(worst, (is - truth).norm());
    }
  }
  return worst;
}

/// Expects a model of the hump to have the strengths of its contacts, and to blend forces by them.
inline void expect_strengths_of_hump(const Model& model,
                                     const Eigen::Affine3d& pose = Eigen::Affine3d::Identity()) {
  const double scale = std::cbrt(pose.linear().determinant());
  const double depth = model.interpolation.reference_depth / scale;
  Model linear = model;
  linear.interpolation = {};
  for (ContactModel& contact : linear.contacts) {
    const Eigen::Vector3d place = pose.inverse() * contact.position;
    const double work = potential(hump_field(place.x(), place.y()), {0, 0, depth});
    ASSERT_TRUE(contact.strength);
    // The forces of the same material go with the square of its size.
    EXPECT_NEAR(contact.strength->value, scale * scale * work / depth, kForceRounding);
    contact.strength.reset();
  }
  EXPECT_LT(worst_error_of_hump(model, pose), 0.5 * worst_error_of_hump(linear, pose));
}

}  // namespace palpate::haptics
