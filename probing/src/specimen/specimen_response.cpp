// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/specimen_response.h"

#include "palpate/core/error.h"

namespace palpate::probing {
namespace {

template <typename Displacement>
std::optional<Eigen::Vector3d> displacement_or_reason(const Displacement& displacement,
                                                      std::string& reason) {
  try {
    return displacement();
  } catch (const SolverError& none) {
    reason = none.what();
  } catch (const InvalidInput& unreachable) {
    reason = unreachable.what();
  }
  return std::nullopt;
}

}  // namespace

std::optional<Eigen::Vector3d> response_of(const Specimen& specimen, const Eigen::Vector3d& contact,
                                           const Eigen::Vector3d& force, std::string& reason) {
  return displacement_or_reason([&] { return specimen.displacement(contact, force); }, reason);
}

std::optional<Eigen::Vector3d> response_of(SpecimenContact& contact, const Eigen::Vector3d& force,
                                           std::string& reason) {
  return displacement_or_reason([&] { return contact.displacement(force); }, reason);
}

}  // namespace palpate::probing
