// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "import/tip_slides.h"

#include <algorithm>
#include <cmath>

namespace palpate::probing {

TipSlides::TipSlides(std::size_t touch, const Eigen::Vector3d& tip, const Eigen::Vector3d& force,
                     double same_force, double slide_length)
    : same_force_(same_force), slide_length_(slide_length), touch_{touch, tip, force, 0} {}

std::optional<TipSlide> TipSlides::add(std::size_t moment, const Eigen::Vector3d& tip,
                                       const Eigen::Vector3d& force) {
  const double strength = force.norm();
  if (strength > 0) compliance_ = std::max(compliance_, (tip - touch_.tip).norm() / strength);
  const std::array<double, 3> step = {std::floor(force.x() / same_force_),
                                      std::floor(force.y() / same_force_),
                                      std::floor(force.z() / same_force_)};
  const auto [found, first] = visits_.try_emplace(step, Visit{moment, tip, force, compliance_});
  return first ? std::nullopt : compare(found->second, tip, force);
}

std::optional<TipSlide> TipSlides::release(const Eigen::Vector3d& tip,
                                           const Eigen::Vector3d& force) const {
  return compare(touch_, tip, force);
}

std::optional<TipSlide> TipSlides::compare(const Visit& visit, const Eigen::Vector3d& tip,
                                           const Eigen::Vector3d& force) const {
  const Eigen::Vector3d way = tip - visit.tip, along = visit.force.normalized();
  const double across = (way - way.dot(along) * along).norm();
  // The displacement of the object due to the difference of the forces.
  const double elastic = visit.compliance * ((force - visit.force).norm() + same_force_);
  if (!(across > slide_length_ + elastic)) return std::nullopt;
  return TipSlide{visit.moment, visit.tip, (visit.force + force) / 2};
}

}  // namespace palpate::probing
