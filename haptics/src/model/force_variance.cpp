// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "model/force_variance.h"

#include <cmath>

namespace palpate::haptics {

ForceVariance force_variance(std::span<const ContactModel> contacts, const Blend& at,
                             const Eigen::Vector3d& place,
                             const Eigen::Vector3d& displacement) noexcept {
  ForceVariance result;
  const Eigen::Vector3d local = at.field_frame.transpose() * displacement;
  Eigen::Vector3d whole = Eigen::Vector3d::Zero();
  double square = 0;                                 // [mm^2] mean squared distance to the contacts
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  // of the contacts, from the place
  double contrast = 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(at.contacts.count); ++k) {
    const double weight = at.contacts.weights[k];
    if (!(weight > 0)) continue;
    const ContactModel& contact = contacts[static_cast<std::size_t>(at.contacts.contacts[k])];
    const Eigen::Matrix3d& map = at.warps[k].displacement;
    const double energy = at.warps[k].energy;
    const Eigen::Matrix3d stiff =
        energy * (map.transpose() * stiffness(contact.field, map * local) * map);
    const Eigen::Vector3d force = energy * haptics::force(contact.field, map * local);
    whole += weight * (map.transpose() * force);
    square += weight * (place - contact.position).squaredNorm();
    middle += weight * (contact.position - place);
    contrast += weight * std::pow(std::log(energy), 2);
    if (!contact.uncertainty) continue;
    const ContactUncertainty& own = *contact.uncertainty;
    const double scale = energy * map.norm() / std::sqrt(3.0);  // of forces
    result.contacts += weight * (std::pow(own.force * scale, 2) +
                                 own.displacement * own.displacement * stiff.squaredNorm() +
                                 own.across * own.across * force.head<2>().squaredNorm());
    result.between += weight * own.between * own.between;
  }
  // Along the surface; on a curved one contacts all around lie below the tangent plane.
  const double beyond = (at.field_frame.leftCols<2>().transpose() * middle).squaredNorm();
  result.reach = geometry::error_reach(square, beyond);
  result.distance = geometry::error_growth(result.reach) * whole.squaredNorm();
  result.contrast = kContrastError * kContrastError * contrast * whole.squaredNorm();
  return result;
}

}  // namespace palpate::haptics
