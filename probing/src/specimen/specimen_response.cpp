// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/specimen_response.h"

#include "palpate/error.h"

namespace palpate::probing {

std::optional<Eigen::Vector3d> response_of(const Specimen& specimen, const Eigen::Vector3d& contact,
                                           const Eigen::Vector3d& force, std::string& reason) {
  try {
    return specimen.displacement(contact, force);
  } catch (const SolverError& none) {
    reason = none.what();
  } catch (const InvalidInput& unreachable) {
    reason = unreachable.what();
  }
  return std::nullopt;
}

}  // namespace palpate::probing
