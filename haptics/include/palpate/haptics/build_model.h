// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "palpate/core/fields.h"
#include "palpate/geometry/triangle_mesh.h"
#include "palpate/haptics/force_field_fit.h"
#include "palpate/haptics/friction_axis.h"
#include "palpate/haptics/friction_cone.h"
#include "palpate/haptics/model.h"
#include "palpate/haptics/pressing_estimate.h"
#include "palpate/haptics/rate_fit.h"
#include "palpate/haptics/shared_local_part.h"
#include "palpate/probing/acquisition.h"
#include "palpate/probing/contact_misfit.h"

namespace palpate::haptics {

/// The stages of `build_model` that take long.
enum class BuildStage {
  friction,  ///< fitting the friction cone of each contact
  fields     ///< fitting the force field of each contact
};

/// Options of `build_model`: what is measured and how fields are fitted. `visit` lists the meaning,
/// unit and range of the fields that users set; docs/options.md shows this list.
struct BuildOptions {
  FitOptions fit;  ///< `fit.noise.force` is not used: see `force_noise`
  /// For `force_noise` another than its own, its steady error changes in proportion. With 0.01 N
  /// of it, 34 of 36 lower bounds hold that the virtual arm measured, with 0.015 N all; without, 15
  /// (docs/probing-validation.md).
  FrictionOptions friction = {.steady_error = 0.015};
  std::optional<double> budget = std::nullopt;
  std::optional<double> force_noise = std::nullopt;
  double on_surface = 0.2;
  double max_distance = 2;
  double max_motion = 5;
  std::optional<int> max_left_out = std::nullopt;
  /// The reference force of compliances is the lower quartile over contacts of the largest force
  /// along the z axis; if it is not positive, forces are blended.
  std::optional<BlendRule> blend_rule = std::nullopt;
  geometry::ContactTriangulationMethod triangulation =
      geometry::ContactTriangulationMethod::delaunay;
  std::optional<int> dense_samples = std::nullopt;
  bool estimate_offsets = true;
  bool rate = false;
  /// Called after each contact with the number of contacts done in this stage and in all, from one
  /// thread at a time. Contacts with a known fit are reported together. An exception that it throws
  /// ends the work.
  std::function<void(BuildStage stage, int done, int total)> progress = {};
  /// Called before a contact is fitted. Returns the fit that an earlier call with the same
  /// acquisition, surface, fit options and `dense_samples` passed to `keep_fit`, or null.
  std::function<const FitResult*(long long contact)> known_fit = {};
  /// Called with each new fit, before `progress`, from one thread at a time.
  std::function<void(long long contact, const FitResult& fit)> keep_fit = {};
};

void visit(BuildOptions& options, FieldVisitor& visitor);

enum class RegistrationOutcome {
  not_needed,    ///< the contacts lie on the surface already
  accepted,      ///< the contacts were moved onto the surface, rigidly
  too_far,       ///< the motion exceeds max_motion; the contacts were not moved
  not_converged  ///< the contacts were not moved
};

/// "not_needed", "accepted", ...
[[nodiscard]] const char* to_string(RegistrationOutcome outcome);

struct ContactReport {
  long long id = 0;
  double distance = 0;            ///< [mm] to the surface, after registration
  FitResult fit;                  ///< in the contact's frame
  FrictionFit friction;           ///< in the world frame
  FrictionAxisFit friction_axis;  ///< in the world frame
  int pairs = 0;                  ///< of displacement and force, to which the field is fitted
  double force_rms = 0;           ///< [N] root mean square of their forces
  double largest_force = 0;       ///< [N] of their forces
  /// Samples that contradict the friction cone (`contradicting_trials`), and all samples.
  std::optional<int> friction_contradictions = std::nullopt;
  int friction_trials = 0;
};

/// Returns true if the fit of a contact can be used: its rms is finite and at most the largest
/// force measured there. Zero force everywhere explains the measurements better than a worse fit.
[[nodiscard]] bool is_usable(const ContactReport& report);

/// [0, 1] Share of the squared forces of all contacts that their fits explain.
[[nodiscard]] double explained_share(const std::vector<ContactReport>& contacts);

/// [N] Root mean square of the errors at all samples, each contact predicted from those around it,
/// by each rule.
struct RuleErrors {
  double compliances = 0, forces = 0;
};

using probing::ContactMisfit;

struct BuildResult {
  Model model;
  std::vector<ContactReport> contacts;     ///< in the order of the model's contacts
  std::vector<long long> without_samples;  ///< ids of contacts left out because they have none
  std::vector<ContactMisfit> left_out;     ///< those that do not fit the surface
  std::vector<long long> isolated;         ///< ids of contacts in no triangle of contacts
  /// In the contacts' frames; only with `dense_samples`.
  std::optional<LocalPart> local_part;
  /// If all contacts were only pressed: what their fields were made of, in the order of the model's
  /// contacts and the frame of the acquisition.
  std::optional<PressingEstimate> pressing;
  /// With `BuildOptions::rate`: what was found; without terms if the samples show no dependence.
  std::optional<RateFit> rate;
  /// If the friction of the object depends on the load: how.
  std::optional<FrictionLoadEstimate> friction_load;
  std::optional<RuleErrors> rule_errors;  ///< if they chose the rule between contacts
  RegistrationOutcome registration = RegistrationOutcome::not_needed;
  /// [mm] of the contacts to the surface as given, without those that cannot fit it (further away
  /// than max_distance + max_motion) if at least three can
  double distance_rms = 0;
  /// The triangles of the surface were reversed to agree with the normals of the contacts.
  bool surface_flipped = false;
  /// Vertices that the model's surface has beyond those of the given one: 2 x M, each lies in the
  /// middle of these two (`geometry::split_edges`).
  Eigen::Matrix2Xi surface_ends;
};

/// Makes a model from measurements. The contacts are registered to the surface, moved onto it and
/// triangulated (thesis 5.3.2.1). A friction cone and a force field are fitted at each of them, in
/// parallel; the result does not depend on the number of threads. Displacements are relative to the
/// contact as measured. All numbers of the contacts are `rounded`.
///
/// Weights between contacts are linear along the edges of the surface. Edges that are longer than
/// two thirds of the distance between contacts there are therefore split; the shape stays.
///
/// If all contacts were only pressed (no sample has a tangential stage), displacements lie along
/// one direction, which is too little for a fit of its own. The fields then follow
/// `estimate_pressing`, whose offsets are subtracted and recorded in `Model::pressing_offsets`;
/// errors refer to samples without the offsets.
///
/// A ball in a soft object slips at larger forces than a point with the same friction. If the
/// acquisition states the radius of its probe, the errors and lower bounds of friction hold for the
/// material as well, unless `BuildOptions::friction.steady_error` is 0: trials of an exact cone.
///
/// A normal points into the surface if the triangle there faces the other way, and so does most of
/// the surface over the radius of the probe (`geometry::facing_shares`; `probing::kUsualTipRadius`
/// if it is not known).
///
/// \throws InvalidInput if the acquisition, the surface or an option is not valid, if a rate is asked
/// for and not all contacts were only pressed or samples of one have the same time, if more than
/// max_left_out contacts are further than max_distance from the surface or have a normal that
/// points into it, or if fewer than three contacts have samples and fit the surface.
/// \throws SolverError if the fit of a contact cannot be used (`is_usable`), naming these contacts,
/// or if a field gives more than ten times the largest measured force at one of its own samples.
[[nodiscard]] BuildResult build_model(const probing::CheckedAcquisition& acquisition,
                                      const geometry::TriangleMesh& surface,
                                      const BuildOptions& options = {});

}  // namespace palpate::haptics
