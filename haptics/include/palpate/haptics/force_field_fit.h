// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "palpate/geometry/eigen_alignment.h"
#include "palpate/haptics/force_field.h"
#include "palpate/haptics/passivity_certificate.h"

namespace palpate::haptics {

/// Guarantee that a fit gives on the energy, and the method it uses.
enum class FitMode {
  convex,     ///< isotropic and ridge bases with weights >= 0: passive everywhere by construction
  certified,  ///< as `local`, with proven passivity over the reachable volume
  local       ///< isotropic bases of any sign; zero is a local minimum of the energy (thesis 5.3.1)
};

/// Standard deviations of each component of the measurements.
struct FitNoise {
  /// [mm] of a displacement; finite and >= 0. Default: kDisplacementNoise.
  std::optional<double> displacement = std::nullopt;
  double force = 0.01;  ///< [N] of a force; finite and >= 0
};

/// [mm] Noise of a realigned displacement if it is unknown; thesis 5.2 reports 0.017 to 0.024 mm
/// for the scatter of each of its two positions.
inline constexpr double kDisplacementNoise = 0.03;

struct FitOptions {
  FitMode mode = FitMode::convex;
  /// With `convex`: if noise does not explain the errors, also try convex fields with fewer bases
  /// and a certified one, and return the field that predicts best. Slow in trials.
  bool try_certified = true;
  /// Do so even if noise explains the errors. For computed pairs: their deviation from any field,
  /// because their force depends on the path of the tool, exceeds their noise, and a few pairs do
  /// not show it.
  bool compare_always = false;
  /// [N] >= 0: stop when the rms is at most this. 0: as accurate as the noise allows.
  double accuracy = 0;
  /// >= 1. Default: kMaxConvexBases for `convex`, kMaxLocalBases for the other modes.
  std::optional<int> max_bases = std::nullopt;
  FitNoise noise = {};  ///< weights the samples; for `convex` also limits the number of bases
  /// [mm] > 0, epsilon of all bases. Default: fitted for each base, starting from the root mean
  /// square of the displacements. Not allowed with `convex`, which chooses its own.
  std::optional<double> epsilon = std::nullopt;
  /// With `convex`: the expected stiffness [N/mm] where the displacements show none;
  /// symmetric, positive semi-definite. Only its ratios between directions count. Default: that of
  /// a half-space pressed along the largest displacements.
  std::optional<Eigen::Matrix3d> expected_stiffness = std::nullopt;
};

inline constexpr int kMaxConvexBases = 14;
inline constexpr int kMaxLocalBases = 6;

/// [us] Approximate time of `force` per base of a field, isotropic or ridge, on a server processor
/// of 2025 at the baseline x86-64-v2; converts a time budget to a number of bases. It is a constant
/// so that the same measurements give the same model on every machine.
inline constexpr double kEvaluationCost = 0.01;

/// Largest chi^2 per degree of freedom that noise explains. Estimated noise is known to some ten
/// per cent, so twice its variance is beyond that.
inline constexpr double kMaxChi2 = 2;

/// A contact counts as rigid if the root mean square of its displacements is at most this many
/// times their noise. Its stiffness is limited to the value that would cause this displacement.
inline constexpr double kRigidRatio = 3;

enum class FitStop {
  accurate,       ///< rms <= accuracy
  explained,      ///< noise explains the errors: chi^2 per degree of freedom <= kMaxChi2
  unexplained,    ///< passive, but chi^2 stays above kMaxChi2: noise does not explain the errors
  rigid,          ///< practically rigid: a spring with a limited stiffness
  max_bases,      ///< `max_bases` reached, or as many bases as the samples can determine
  no_gain,        ///< one more base did not improve the Bayesian information criterion
  not_converged,  ///< the solver did not converge with one more base; the best field so far is
                  ///< returned
  not_determined  ///< forces without any displacement: the field is zero
};

struct FitResult {
  ForceField field;
  /// [N] sqrt(mean |force(displacement) - sample|^2), the length of the error vector
  double rms = 0;
  int iterations = 0;                     ///< of the solver, over all numbers of bases and starts
  FitStop stop = FitStop::not_converged;  ///< check this before you use the field
  /// [N/mm] smallest eigenvalue of the stiffness at zero displacement; >= 0
  double smallest_stiffness = 0;
  /// The mode of the field. It is `certified` instead of `convex` where that is expected to predict
  /// better, and `convex` instead of `certified` where passivity cannot be proven.
  FitMode mode = FitMode::convex;
  PassivityCertificate certificate;  ///< of the field, over the reach of the displacements
  /// Sum of the squared errors in units of their noise, per degree of freedom: about 1 or less if
  /// the noise explains them. Excludes the outliers if they are few.
  double chi2 = 0;
  /// Samples whose error noise cannot explain (its squared length in units of the noise exceeds
  /// 50); with `convex` they hardly count.
  int outliers = 0;
  double noise_floor = 0;         ///< [N] rms that noise alone causes with this stiffness
  double displacement_noise = 0;  ///< [mm] assumed value
  /// Condition number of the least squares of `convex` in all parameters, with columns of unit
  /// length. A large one (1e3) means that bases are exchangeable, not that the field is uncertain.
  std::optional<double> condition = std::nullopt;
  /// Directions, of three, in which the displacements show no stiffness: the field has an expected
  /// one there.
  int unmeasured = 0;
  /// True if it was fitted to a local part that contacts share as well as to its own samples
  /// (`shared_local_part.h`).
  bool shared_local = false;
};

/// Fits a field to pairs of displacement [mm] and force on the object [N], 3 x N each. The result
/// is independent of the order of the samples and the number of threads, and of the units if
/// accuracy and noise are given in them.
///
/// `convex`: all weights are >= 0 and each base, isotropic or a ridge, has its own epsilon, so the
/// energy is convex. Non-negative least squares over a dictionary of bases placed according to the
/// samples is followed by a joint refinement of all parameters (projected Levenberg-Marquardt).
/// Then bases are removed, those that the others replace best first, as long as noise explains the
/// errors (chi^2 is below its mean by at least half a deviation) or Akaike's information criterion
/// improves. The error of sample i has the covariance force^2 I + displacement^2 K K^T of the
/// noise, with the stiffness K there, and a robust loss (Cauchy).
///
/// If noise does not explain the errors, the samples have features that no field has, and a field
/// with many bases follows them, but errs between them. Therefore convex fits that assume 1, 3 and
/// 9 times the noise predict pairs that are left out, a fifth at a time. Returns the best one, or a
/// certified field if its error, by generalised cross-validation, is less. This error is multiplied
/// by the ratio of the field's largest force between rest and the pairs to the measured one.
///
/// If displacements lie in a plane or along a line, up to their noise, and the forces across are no
/// more than those along explain, `convex` treats the deviations as noise and takes the stiffness
/// across from `expected_stiffness`, scaled to that of the other directions: noise divided by noise
/// is no stiffness.
///
/// If the samples do not determine epsilon, it is about half the extent of the displacements;
/// otherwise a staircase through the levels of force would fit as well. A ridge beyond all samples
/// gets an epsilon of at least half its distance: the samples show only its tail, and the fit must
/// not invent a wall where nothing was measured.
///
/// `local` (thesis 5.3.1, Eq 5.6): weights and centres are free; the stiffness at zero is kept
/// positive semi-definite (Eq 5.9). Bases are added one by one. Each starts where it reduces the
/// linear least squares most, among the displacements and their multiples by -1, 2 and -2; then all
/// are refined (Ipopt).
/// \throws InvalidInput if there is no sample, sizes differ, a sample is not finite (naming its
/// index), or an option is outside its range.
[[nodiscard]] FitResult fit_force_field(const Eigen::Ref<const Eigen::Matrix3Xd>& displacements,
                                        const Eigen::Ref<const Eigen::Matrix3Xd>& forces,
                                        const FitOptions& options = {});

/// Assesses a field from any source against samples: all members of the result except `iterations`,
/// `mode` and `condition`. `stop` is `accurate`, `explained` or `unexplained`.
/// \param parameters > 0: number of parameters that were fitted to the samples.
/// \throws InvalidInput as `fit_force_field`.
[[nodiscard]] FitResult assess_force_field(ForceField field,
                                           const Eigen::Ref<const Eigen::Matrix3Xd>& displacements,
                                           const Eigen::Ref<const Eigen::Matrix3Xd>& forces,
                                           int parameters, const FitOptions& options = {});

/// Name for reports: "accurate", "max_bases", ...
[[nodiscard]] const char* to_string(FitStop stop);
/// "convex", "certified" or "local".
[[nodiscard]] const char* to_string(FitMode mode);

}  // namespace palpate::haptics
