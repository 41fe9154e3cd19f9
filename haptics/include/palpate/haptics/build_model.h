// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"
#include "palpate/haptics/force_field_fit.h"
#include "palpate/haptics/friction_axis.h"
#include "palpate/haptics/friction_cone.h"
#include "palpate/haptics/model.h"
#include "palpate/haptics/shared_local_part.h"
#include "palpate/probing/acquisition.h"

namespace palpate::haptics {

/// What takes its time.
enum class BuildStage {
  friction,  ///< the cone of each contact
  fields     ///< the force field of each contact
};

struct BuildOptions {
  FitOptions fit;
  FrictionOptions friction = {};
  /// [mm] the contacts lie on the surface already, and are not moved, iff the root mean square of
  /// their distances is <= this; >= 0
  double on_surface = 0.2;
  double max_distance = 2;  ///< [mm] from the surface, of each contact once in place; >= 0
  double max_motion = 5;    ///< [mm] of any contact by the registration; >= 0
  /// Of forces between contacts. The reference force of compliances is the lower quartile over
  /// contacts of the largest force along the z axis; if that is not positive, forces are blended.
  BlendRule blend_rule = BlendRule::compliances;
  /// Contacts with fewer pairs of displacement and force than this share the local part of those
  /// that have as many or more, if they gain by it (`LocalGlobalOptions::dense_samples`); >= 12.
  /// Without one each contact is fitted on its own.
  std::optional<int> dense_samples = std::nullopt;
  /// Called after each contact with the number of those done in that stage and of all, from one
  /// thread at a time; those with a known fit count as one. What it throws ends the work.
  std::function<void(BuildStage stage, int done, int total)> progress = {};
  /// Asked before a contact is fitted: what an earlier call with the same acquisition, surface and
  /// fit options, and the same `dense_samples`, gave to `keep_fit`, or null.
  std::function<const FitResult*(long long contact)> known_fit = {};
  /// Given each new fit, before `progress` is called, from one thread at a time.
  std::function<void(long long contact, const FitResult& fit)> keep_fit = {};
};

enum class RegistrationOutcome {
  not_needed,    ///< the contacts lie on the surface already
  accepted,      ///< they were moved onto it, rigidly
  too_far,       ///< the motion exceeds max_motion: not moved
  not_converged  ///< not moved
};

/// "not_needed", "accepted", ...
[[nodiscard]] const char* to_string(RegistrationOutcome outcome);

struct ContactReport {
  long long id = 0;
  double distance = 0;            ///< [mm] to the surface, once in place, before it was put on it
  FitResult fit;                  ///< in the contact's frame
  FrictionFit friction;           ///< in the world frame
  FrictionAxisFit friction_axis;  ///< in the world frame
};

struct BuildResult {
  Model model;
  std::vector<ContactReport> contacts;     ///< in the order of the model's contacts
  std::vector<long long> without_samples;  ///< ids of contacts that were left out for that
  std::vector<long long> isolated;         ///< ids of contacts in no triangle of contacts
  /// Where it was looked for, in the contacts' frames; with `dense_samples` only.
  std::optional<LocalPart> local_part;
  RegistrationOutcome registration = RegistrationOutcome::not_needed;
  double distance_rms = 0;  ///< [mm] of the contacts to the surface as given
  bool surface_flipped =
      false;  ///< the surface's triangles were turned over to agree with the normals
};

/// Makes a model of measurements: contacts are registered to the surface and put on it,
/// triangulated (thesis 5.3.2.1), and at each a force field and a friction cone are fitted, in
/// parallel; the result does not depend on the number of threads. A displacement counts from the
/// contact as measured. Contacts are as `rounded` gives them.
/// \throws InvalidInput on a bad acquisition, surface or option, a contact further than
/// max_distance from the surface or with its normal into it, or fewer than three contacts with
/// samples.
[[nodiscard]] BuildResult build_model(const probing::Acquisition& acquisition,
                                      const geometry::TriangleMesh& surface,
                                      const BuildOptions& options = {});

}  // namespace palpate::haptics
