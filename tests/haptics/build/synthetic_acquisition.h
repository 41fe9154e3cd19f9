// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "palpate/probing/acquisition.h"
#include "sheet_model.h"

namespace palpate::haptics {

/// Measurements of an object that gives the same isotropic spring everywhere on the flat surface of
/// sheet_model.h: contacts on a grid, normal forces, tangential forces in eight directions up to
/// the friction limit, where one sample holds and the next slips.
inline probing::Acquisition flat_acquisition(double friction = 0.5) {
  probing::Acquisition acquisition;
  // The displacement for a force f along itself: |f| = w d / sqrt(d^2 + eps^2).
  const auto displacement = [](const Eigen::Vector3d& f) -> Eigen::Vector3d {
    const double ratio = f.norm() / 9;
    return f.normalized() * 20 * ratio / std::sqrt(1 - ratio * ratio);
  };
  long long group = 0;
  for (int i = 0; i < 9; ++i) {
    const probing::Contact contact{
        20 + i, {30.0 * (i % 3 - 1), 30.0 * (i / 3 - 1), 700}, {0, 0, -1}};
    acquisition.contacts.push_back(contact);
    for (const double normal : {0.5, 1.5, 3.0}) {
      ++group;
      const Eigen::Vector3d pressed(0, 0, normal);
      for (int direction = 0; direction < 8; ++direction) {
        const double angle = direction * std::numbers::pi / 4;
        for (const double part : {0.5, 0.99, 1.01}) {
          const double tangential = part * friction * normal;
          const Eigen::Vector3d force(tangential * std::cos(angle), tangential * std::sin(angle),
                                      normal);
          acquisition.samples.push_back({.id = static_cast<long long>(acquisition.samples.size()),
                                         .contact = contact.id,
                                         .group = group,
                                         .force = force,
                                         .a = contact.position + displacement(pressed),
                                         .b = contact.position + displacement(force),
                                         .on_friction_boundary = part == 0.99,
                                         .slipped = part > 1});
        }
      }
    }
  }
  return acquisition;
}

}  // namespace palpate::haptics
