// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "palpate/haptics/force_field_fit.h"
#include "palpate/haptics/realignment.h"

namespace palpate::haptics {

/// Smallest number of pairs of a dense contact: three numbers per pair determine the six of G_i,
/// and as many again the local part.
inline constexpr int kFewestDenseSamples = 12;

struct LocalGlobalOptions {
  FitOptions fit = {};  ///< for the fields used in playback
  /// A contact is dense if it has at least this many pairs; >= kFewestDenseSamples.
  int dense_samples = 40;
};

enum class SharingOutcome {
  shared,         ///< sparse contacts improve with the local part of the dense ones
  no_gain,        ///< no significant improvement: the local part differs between contacts
  too_few_dense,  ///< fewer than kFewestDense contacts are dense, too few to learn from
  none_sparse     ///< all contacts are dense, so none needs it
};

/// Name of an outcome: "shared", "no_gain", ...
[[nodiscard]] const char* to_string(SharingOutcome outcome);

/// Smallest number of dense contacts for a meaningful standard error of the gain.
inline constexpr int kFewestDense = 3;

/// The local part that dense contacts have in common. Model: springs in series (thesis 6.2.1.2).
/// The displacement at contact i under a force f, in its local frame, is
///   d_i(f) = l(f) + G_i f,
/// where the local part l is the gradient of a convex function and the same at all contacts, and
/// the symmetric compliance G_i describes how the object as a whole yields there. A linear
/// compliance common to all contacts can belong to either. All that the stiffest dense contact has
/// is assigned to l, so G_i may be negative, but d_i is monotone.
struct LocalPart {
  SharingOutcome outcome = SharingOutcome::too_few_dense;
  /// l, with displacement and force exchanged: `force(local, f)` is the displacement [mm] under the
  /// force f [N], and `stiffness(local, f)` the compliance [mm/N]. Weights are in mm, centres and
  /// epsilons in N.
  ForceField local;
  /// [mm/N] mean of G_i over the dense contacts, used where samples do not determine G_i
  Eigen::Matrix3d mean_global = Eigen::Matrix3d::Zero();
  /// [mm/N] Frobenius norm of the mean compliance at the dense contacts: scale of the prior
  /// deviation of G_i from its mean
  double mean_compliance = 0;
  Eigen::Matrix3Xd forces;  ///< [N] 3 x M, representative of those at the dense contacts
  FitNoise noise;           ///< of all contacts together, including the displacement noise
  int dense_samples = 0;    ///< as in the options
  int dense = 0;            ///< number of dense contacts
  int sparse = 0;           ///< number of sparse contacts
  /// Mean of log(error with the local part / error of an own fit) on held-out pairs of dense
  /// contacts that were treated as sparse; -0.7 halves the error. Only with trials.
  std::optional<double> gain = std::nullopt;
  std::optional<double> gain_error = std::nullopt;  ///< standard error of `gain`
};

/// Learns the local part of an object at which few contacts were sampled densely.
///
/// Alternately, l is fitted to d - G_i f at the dense contacts (`fit_force_field`, convex, with
/// force and displacement exchanged), and G_i to d - l(f) by robust least squares. A trial decides
/// whether the model applies: of each dense contact the pairs whose forces are closest to those of
/// a sparse contact are kept, and the others are predicted with the local part of the other dense
/// contacts, and by a fit to the kept pairs alone. The local part is shared if the mean gain is at
/// least twice its standard error. The result does not depend on the order of contacts or samples,
/// nor on threads.
/// \param contacts samples of contact i in its local frame, z into the object; frames of neighbours
/// should agree on x.
/// \throws InvalidInput if there is no contact, a contact has no samples or samples that are not
/// finite (naming the contact), or an option is outside its range.
[[nodiscard]] LocalPart learn_local_part(std::span<const ForceSamples> contacts,
                                         const LocalGlobalOptions& options = {});

struct SeriesFit {
  /// For playback, like any other; the figures refer to the contact's own samples. `shared_local`
  /// is true if it includes the local part.
  FitResult fit;
  /// [mm/N] G; zero unless the field includes the local part
  Eigen::Matrix3d global_compliance = Eigen::Matrix3d::Zero();
};

/// Fits the field of a contact. If the local part is shared and the contact is sparse, G is found
/// by robust least squares, and an ordinary field is fitted to pairs (l(f) + G f, f) over the
/// forces of the dense contacts (thesis 6.2.1.3), in the mode of the options. Otherwise, or if
/// noise does not explain the remaining errors while a fit to the samples alone predicts held-out
/// samples better, this fit to the samples alone is returned.
/// \throws InvalidInput as `fit_force_field`.
[[nodiscard]] SeriesFit fit_with_local_part(const ForceSamples& samples, const LocalPart& part,
                                            const FitOptions& options = {});

}  // namespace palpate::haptics
