// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "palpate/core/fields.h"
#include "palpate/geometry/eigen_alignment.h"
#include "palpate/probing/specimen.h"
#include "palpate/probing/specimen_response.h"

namespace palpate::probing {

/// A force on an object and the displacement that it causes.
struct KnownForce {
  Eigen::Vector3d contact = Eigen::Vector3d::Zero();       ///< [mm] on the undeformed surface
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< [mm] of the tip
  Eigen::Vector3d force = Eigen::Vector3d::Zero();         ///< [N] on the object
};

/// The meaning, unit and range of each field stand in its list, `visit`.
struct KnownForceOptions {
  int queries = 400;
  double margin = 8;
  double least_force = 0.1;
  double max_force = 3;  ///< >= least_force
  unsigned seed = 1;
  /// Called after each force with the number of forces done and in all, from one thread at a time.
  /// An exception that it throws ends the work.
  std::function<void(int done, int total)> progress = {};
};

void visit(KnownForceOptions& options, FieldVisitor& visitor);

struct KnownForces {
  std::vector<KnownForce> forces;
  std::vector<UnansweredForce> unanswered;  ///< of `queries`, those without a displacement
};

/// Computes known forces, to compare a model with. Places are random; each triangle is equally
/// likely. Sizes are uniform from `least_force` to `max_force`. Directions are random within the
/// friction cone of 0.9 of the coefficient. Computed in parallel; the result does not depend on the
/// number of threads.
/// \throws InvalidInput if an option is outside its range, or no triangle is as far from the border
/// as `margin` says.
[[nodiscard]] KnownForces known_forces(const Specimen& specimen,
                                       const KnownForceOptions& options = {});

}  // namespace palpate::probing
