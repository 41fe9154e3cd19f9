// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/probing/specimen.h"

namespace palpate::probing::support {

/// An object that has no equilibrium beyond a force [N] that depends on the place.
class WeakSpecimen final : public Specimen {
 public:
  WeakSpecimen(std::unique_ptr<Specimen> whole,
               std::function<double(const Eigen::Vector3d&)> strength)
      : whole_(std::move(whole)), strength_(std::move(strength)) {}
  const geometry::TriangleMesh& surface() const override { return whole_->surface(); }
  Eigen::Vector3d displacement(const Eigen::Vector3d& contact,
                               const Eigen::Vector3d& force) const override {
    if (force.norm() > strength_(contact)) throw SolverError("the object is too weak");
    return whole_->displacement(contact, force);
  }
  FrictionCone friction_cone(const Eigen::Vector3d& contact) const override {
    return whole_->friction_cone(contact);
  }

 private:
  std::unique_ptr<Specimen> whole_;
  std::function<double(const Eigen::Vector3d&)> strength_;
};

}  // namespace palpate::probing::support
