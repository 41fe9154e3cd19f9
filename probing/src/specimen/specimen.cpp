// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/specimen.h"

#include <utility>

#include "palpate/core/error.h"

namespace palpate::probing {
namespace {

class PlainContact : public SpecimenContact {
 public:
  PlainContact(const Specimen& specimen, Eigen::Vector3d contact)
      : specimen_(specimen), contact_(std::move(contact)) {}
  Eigen::Vector3d displacement(const Eigen::Vector3d& force) override {
    return specimen_.displacement(contact_, force);
  }

 private:
  const Specimen& specimen_;
  Eigen::Vector3d contact_;
};

}  // namespace

Eigen::Matrix3Xd Specimen::deformed_surface(const Eigen::Vector3d& /*contact*/,
                                            const Eigen::Vector3d& /*force*/) const {
  throw InvalidInput(
      "the shape of this object under a force is not known, only the displacement of the tool; the "
      "shapes of elastic_body and finite_elements are");
}

std::unique_ptr<SpecimenContact> Specimen::at(const Eigen::Vector3d& contact) const {
  return std::make_unique<PlainContact>(*this, contact);
}

}  // namespace palpate::probing
