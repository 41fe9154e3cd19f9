// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "palpate/core/fields.h"
#include "palpate/haptics/identify.h"
#include "palpate/probing/acquisition.h"
#include "palpate/probing/finite_element_specimen.h"
#include "palpate/probing/material_text.h"

namespace palpate::haptics {

/// `visit` describes the fields.
struct SolidOptions {
  int max_pairs = 150;
  /// Pairs of displacement and force that are repeated on a mesh of half the size of elements.
  int mesh_pairs = 18;
  /// Called after each equilibrium with the steps done and those expected at most, from one thread
  /// at a time. An exception that it throws ends the work.
  std::function<void(int done, int total)> progress = {};
};

void visit(SolidOptions& options, FieldVisitor& visitor);

struct IdentifiedSolid {
  /// The object as given, with the estimated material, moves of supports and friction. Values that
  /// the data do not determine stay; a shear modulus is multiplied by the factor of all others.
  probing::FiniteElementObject object;
  /// "shear modulus" (or "shear modulus of region 0", ...), "bulk over shear modulus" and, if
  /// supports move, "pre-stretch"; then "friction", which has no part in `correlations`
  Identification report;
  /// Error of each parameter of the report due to the mesh, in its unit; corrected. NaN: not
  /// known.
  std::vector<double> mesh_errors;
  /// Parameters that the measurements would determine, but not with the error of this mesh.
  std::vector<std::string> mesh_limited;
  /// Large normal presses at contacts that are far apart, the largest first.
  std::vector<probing::KnownPress> presses;
  std::vector<long long> left_out;  ///< ids of contacts that the tip cannot reach on this solid
  /// Pairs that are left out since the solid has no equilibrium under their forces.
  int unanswered = 0;
};

/// Estimates the material of a solid whose geometry, supports and regions are known, from measured
/// displacements of a ball and their forces.
///
/// The displacement of a contact under a force is that of `ContactEquilibrium`; the ball comes
/// along the contact's normal. Parameters are the shear modulus of each region; one bulk modulus,
/// for all regions in proportion to their shear moduli as given; and, if supports move, one factor
/// for all moves. They begin at the values given, which may be wrong by a factor of 60 altogether.
/// The estimate is the one that identify.h describes, with derivatives of the equilibria from their
/// factored tangents (`ContactEquilibrium::sensitivity`).
///
/// Displacements on a mesh are off by some per cent, and pairs of a contact share this error. Some
/// pairs, with large and small forces, are therefore repeated on a mesh of half the size. The
/// effect of the difference on each parameter is corrected and contributes to the standard error; a
/// parameter that changes by about a third or more is not determined, and `object` has the best
/// fit. The remaining scatter contributes to the weights, and standard errors are at least those
/// that the scatter of contacts shows.
///
/// The friction is the mean of the coefficients of contacts where their cone is determined. A round
/// tip slides at a larger force than a point, see docs/probing-validation.md.
/// \throws InvalidInput if an option is outside its range, the solid is not valid, a contact is
/// further from it than the radius of the tip, the acquisition states another radius or there is no
/// sample; SolverError if no equilibrium is found with any modulus near those given.
[[nodiscard]] IdentifiedSolid identify_solid(const probing::CheckedAcquisition& acquisition,
                                             const probing::FiniteElementObject& object,
                                             const SolidOptions& solid = {},
                                             const IdentifyOptions& options = {});

}  // namespace palpate::haptics
