// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "palpate/haptics/force_field_fit.h"
#include "palpate/haptics/realignment.h"

namespace palpate::haptics {

/// Pairs of which a dense contact has at least so many: three numbers each for the six of G_i, and
/// as many again for the local part.
inline constexpr int kFewestDenseSamples = 12;

struct LocalGlobalOptions {
  FitOptions fit = {};  ///< of the fields for playback
  /// A contact is dense iff it has at least so many pairs; >= kFewestDenseSamples
  int dense_samples = 40;
};

enum class SharingOutcome {
  shared,         ///< sparse contacts gain by the local part of the dense ones
  no_gain,        ///< they do not, or not for certain: the local part differs between contacts
  too_few_dense,  ///< fewer than kFewestDense contacts are dense: nothing to learn it from
  none_sparse     ///< all contacts are dense: none needs it
};

/// "shared", "no_gain", ...
[[nodiscard]] const char* to_string(SharingOutcome outcome);

/// Of fewer dense contacts the gain has no standard error worth its name.
inline constexpr int kFewestDense = 3;

/// What dense contacts have in common. Springs in series (thesis 6.2.1.2): the displacement at
/// contact i by a force f, in its local frame, is
///   d_i(f) = l(f) + G_i f,
/// with the local part l, the gradient of a convex function and the same at all contacts, and a
/// symmetric compliance G_i for how the object as a whole gives way there. A linear compliance that
/// all have can belong to either; l is given all that the stiffest dense contact has, so that G_i
/// may be negative, but d_i is monotone.
struct LocalPart {
  SharingOutcome outcome = SharingOutcome::too_few_dense;
  /// l, with the roles of the two exchanged: `force(local, f)` is the displacement [mm] by the
  /// force f [N], `stiffness(local, f)` the compliance [mm/N]. Weights in mm, centres and epsilons
  /// in N.
  ForceField local;
  /// [mm/N] mean of G_i over the dense contacts; G_i where samples do not determine it
  Eigen::Matrix3d mean_global = Eigen::Matrix3d::Zero();
  /// [mm/N] Frobenius norm of the mean compliance at the dense contacts: how far G_i may be from
  /// that mean before samples must speak for it
  double mean_compliance = 0;
  Eigen::Matrix3Xd forces;  ///< [N] 3 x M, spread over those at the dense contacts
  FitNoise noise;           ///< of all contacts together, with a displacement
  int dense_samples = 0;    ///< as in the options
  int dense = 0;            ///< contacts
  int sparse = 0;
  /// Of dense contacts that were treated as sparse: mean of log(error with the local part / error
  /// of an own fit) on the pairs that were held out. -0.7 halves the error. Only with trials.
  std::optional<double> gain = std::nullopt;
  std::optional<double> gain_error = std::nullopt;  ///< its standard error
};

/// Learns the local part of an object of which few contacts were sampled densely.
///
/// l is the convex fit (`fit_force_field`, force and displacement exchanged) to d - G_i f at the
/// dense contacts, G_i the robust least squares to d - l(f), in turns. Whether the object is so is
/// tried: the pairs of a dense contact whose forces are nearest to those of a sparse one are kept,
/// the others are predicted by the local part of the other dense contacts, and by a fit to the kept
/// pairs alone. It is shared iff the mean gain is at least twice its standard error.
///
/// Samples of contact i are in its local frame, z into the object; frames of neighbours should
/// agree on x. The result does not depend on the order of contacts or samples, nor on threads.
/// \throws InvalidInput on no contact, samples of which there is none, or that are not finite
/// (naming the contact), or an option out of its range.
[[nodiscard]] LocalPart learn_local_part(std::span<const ForceSamples> contacts,
                                         const LocalGlobalOptions& options = {});

struct SeriesFit {
  /// For playback, as any other; its figures are those on the contact's own samples. `shared_local`
  /// tells whether the local part is in it.
  FitResult fit;
  /// [mm/N] G; zero unless the local part is in the field
  Eigen::Matrix3d global_compliance = Eigen::Matrix3d::Zero();
};

/// The field of a contact. Where the local part is shared and the contact is sparse: G by robust
/// least squares, then an ordinary field is fitted to pairs (l(f) + G f, f) over the forces that
/// the dense contacts know (thesis 6.2.1.3), in the mode of the options. Else, or if noise does not
/// explain what the series leaves of the samples while a fit of their own predicts them better when
/// held out: that own fit.
/// \throws InvalidInput as `fit_force_field`.
[[nodiscard]] SeriesFit fit_with_local_part(const ForceSamples& samples, const LocalPart& part,
                                            const FitOptions& options = {});

}  // namespace palpate::haptics
