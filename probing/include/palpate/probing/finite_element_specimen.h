// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "palpate/probing/contact_equilibrium.h"
#include "palpate/probing/specimen.h"

namespace palpate::probing {

struct FiniteElementSpecimenOptions {
  double friction = 0.8;  ///< coefficient of the friction cone, about the normal; >= 0
  /// Points of the contact slip too where friction does not hold them. If not, they stick where
  /// they touch: then the object keeps energy, and its displacement exists for each force that
  /// presses.
  bool microslip = false;
  EquilibriumOptions contact;  ///< its friction is ignored
};

/// A solid and how a tool touches it, as a specimen file of the type "finite_elements" states it.
struct FiniteElementObject {
  DeformableBody body;
  FiniteElementSpecimenOptions options;
  std::filesystem::path mesh_file = {};  ///< from which the mesh was read; empty if from none
};

/// A solid as an object to probe. Its surface is the part of its boundary at rest that a camera at
/// the origin sees at less than 70 degrees and no support holds. The displacement is that of the
/// centre of the tip, which comes along the normal, from the place where it first touches.
/// \throws InvalidInput, SolverError as `ContactEquilibrium` does, and if the camera sees nothing.
[[nodiscard]] std::unique_ptr<Specimen> make_specimen(
    DeformableBody body, const FiniteElementSpecimenOptions& options = {});

}  // namespace palpate::probing
