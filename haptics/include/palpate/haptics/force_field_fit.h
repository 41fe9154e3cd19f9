// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "palpate/haptics/force_field.h"
#include "palpate/haptics/passivity_certificate.h"

namespace palpate::haptics {

/// What a fit promises of the energy, and how it looks for it.
enum class FitMode {
  convex,     ///< isotropic and ridge bases with weights >= 0: passive everywhere, by construction
  certified,  ///< as `local`, and passivity over the reachable volume is proven
  local       ///< isotropic bases of any sign; zero is a local minimum of the energy (thesis 5.3.1)
};

/// Standard deviations of each component of what was measured.
struct FitNoise {
  /// [mm] of a displacement; finite and >= 0; without one kDisplacementNoise
  std::optional<double> displacement = std::nullopt;
  double force = 0.01;  ///< [N] of a force; finite and >= 0
};

/// [mm] of a realigned displacement, if nothing is known: thesis 5.2 has 0.017 to 0.024 mm for the
/// scatter of each of its two positions.
inline constexpr double kDisplacementNoise = 0.03;

struct FitOptions {
  FitMode mode = FitMode::convex;
  /// With `convex`: also try `certified` where noise does not explain the errors, and return the
  /// better field. Not needed for pairs that are computed, and slow for trials.
  bool try_certified = true;
  /// [N] >= 0: an rms up to this is good enough. 0: as good as the noise allows.
  double accuracy = 0;
  /// >= 1; without one kMaxConvexBases, or kMaxLocalBases for the other modes
  std::optional<int> max_bases = std::nullopt;
  FitNoise noise = {};  ///< weighs samples and decides how many bases they are worth in `convex`
  /// [mm] > 0, kept for all bases; without one each is fitted, from the root mean square of the
  /// displacements on. Not with `convex`, which chooses its own
  std::optional<double> epsilon = std::nullopt;
};

inline constexpr int kMaxConvexBases = 14;
inline constexpr int kMaxLocalBases = 6;

/// [us] about what `force` takes for one base of a field, isotropic or ridge, on a server processor
/// of 2025 at the baseline x86-64-v2: what a budget of time is turned into bases with. A constant,
/// for the same measurements must give the same model whatever machine is at work.
inline constexpr double kEvaluationCost = 0.01;

/// Largest chi^2 per degree of freedom that still counts as explained by noise. Noise that was
/// estimated is known to some ten per cent; twice its variance is more than that.
inline constexpr double kMaxChi2 = 2;

/// A contact is as good as rigid iff the root mean square of its displacements is at most this
/// many times their noise. Its stiffness is capped at what would move it just so far.
inline constexpr double kRigidRatio = 3;

enum class FitStop {
  accurate,       ///< rms <= accuracy
  explained,      ///< noise explains the errors: chi^2 per degree of freedom <= kMaxChi2
  unexplained,    ///< passive, but noise does not explain the errors: chi^2 stays above kMaxChi2
  rigid,          ///< as good as rigid: a spring with a capped stiffness
  max_bases,      ///< `max_bases` are in use, or as many as the samples can determine
  no_gain,        ///< one more base did not pay by the Bayesian information criterion
  not_converged,  ///< the solver did not settle with one more base; the best field so far is
                  ///< returned
  not_determined  ///< forces without any displacement: the field is zero
};

struct FitResult {
  ForceField field;
  /// [N] sqrt(mean |force(displacement) - sample|^2), the length of the error vector
  double rms = 0;
  int iterations = 0;                     ///< of the solver, over all numbers of bases and starts
  FitStop stop = FitStop::not_converged;  ///< read this before you use the field
  /// [N/mm] smallest eigenvalue of the stiffness at zero displacement; >= 0
  double smallest_stiffness = 0;
  /// The mode of the field. It is `certified` instead of `convex` where that explains the samples
  /// better, and `convex` instead of `certified` where passivity cannot be proven.
  FitMode mode = FitMode::convex;
  PassivityCertificate certificate;  ///< of the field, over the reach of the displacements
  /// Sum of the squared errors, each in units of its noise, per degree of freedom: about 1 or less
  /// where the noise explains them. Without the outliers if they are few
  double chi2 = 0;
  /// Samples whose error noise does not make (the square of its length in units of the noise is
  /// over 50): in `convex` they hardly count
  int outliers = 0;
  double noise_floor = 0;         ///< [N] the rms that noise alone makes with this stiffness
  double displacement_noise = 0;  ///< [mm] that was assumed
  /// Condition number of the least squares of `convex` in all parameters, with columns of unit
  /// length. A large one (1e3) says that bases could be exchanged, not that the field is uncertain.
  std::optional<double> condition = std::nullopt;
  /// Fitted to a local part that contacts share and to its own samples (`shared_local_part.h`), not
  /// to these alone
  bool shared_local = false;
};

/// Fits a field to pairs of displacement [mm] and force on the object [N], 3 x N each.
///
/// `convex`: all weights >= 0, each base isotropic or a ridge with its own epsilon: the energy is
/// convex. The non-negative least squares over a dictionary of bases, laid out by the samples, is
/// followed by a joint refinement of all parameters (projected Levenberg-Marquardt) and the removal
/// of bases, those that the others can replace best first: for as long as noise explains the errors
/// (chi^2 is below its mean, by half a deviation or more), or Akaike's information criterion
/// gains. An error of sample i has the covariance force^2 I + displacement^2 K K^T of the noise,
/// with K the stiffness there, and a robust loss (Cauchy). Where samples do not tell epsilon, it is
/// near half the extent of the displacements: steps of a staircase between levels of force would
/// fit as well. A ridge that stands beyond all samples is rounded over at least half of how far:
/// they show its tail only, and nothing calls for a wall where nothing was measured.
///
/// `local` (thesis 5.3.1, Eq 5.6): weights and centres are free, the stiffness at zero is kept
/// positive semi-definite (Eq 5.9). Bases are added one by one. Each starts where it alone lowers
/// the linear least squares most, among the displacements and their multiples by -1, 2 and -2; then
/// all are moved (Ipopt).
///
/// No result depends on order or threads, nor on units if accuracy and noise are given in them.
/// \throws InvalidInput on no sample, sizes that differ, a sample that is not finite (naming its
/// index), or an option out of its range.
[[nodiscard]] FitResult fit_force_field(const Eigen::Ref<const Eigen::Matrix3Xd>& displacements,
                                        const Eigen::Ref<const Eigen::Matrix3Xd>& forces,
                                        const FitOptions& options = {});

/// What samples say of a field, however it was found: all figures of the result but `iterations`,
/// `mode` and `condition`. `parameters` > 0: so many numbers were fitted to the samples. It is
/// `accurate`, `explained` or `unexplained`.
/// \throws InvalidInput as `fit_force_field`.
[[nodiscard]] FitResult assess_force_field(ForceField field,
                                           const Eigen::Ref<const Eigen::Matrix3Xd>& displacements,
                                           const Eigen::Ref<const Eigen::Matrix3Xd>& forces,
                                           int parameters, const FitOptions& options = {});

/// In a word, for reports: "accurate", "max_bases", ...
[[nodiscard]] const char* to_string(FitStop stop);
/// "convex", "certified" or "local"
[[nodiscard]] const char* to_string(FitMode mode);

}  // namespace palpate::haptics
