// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::haptics {

/// A contact that was only pressed: positions and forces of the tool along about one direction.
/// All vectors are in one world frame.
struct PressedContact {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();    ///< [mm] of the touch, as recorded
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit vector into the object
  Eigen::Matrix3Xd displacements;  ///< [mm] 3 x N, tool minus recorded touch; N >= 1
  Eigen::Matrix3Xd forces;         ///< [N] 3 x N, of the tool on the object, as recorded
  std::vector<bool> unloading;     ///< N: recorded on the way back; empty if none was
  double height = 0;  ///< [mm] depth of the recorded touch below the surface of the object
};

struct PressingOptions {
  /// If true, estimates a constant error of the force, and touches found late. They are used only
  /// if the Bayesian information criterion supports them.
  bool estimate_offsets = true;
  /// [N] > 0, of each component. Default: estimated from the data.
  std::optional<double> force_noise = std::nullopt;
};

/// The common errors of the records of an acquisition, beside the object itself. A record at depth
/// d below its touch reads F(d + t) u + b: t is the depth of the touch below the true surface, u is
/// 1 or, on the way back, 1 - `hysteresis`.
struct PressingOffsets {
  bool force_found = false;  ///< the data support a constant error of the force
  bool touch_found = false;  ///< the data support touches below the true surface
  /// [N] b in the world frame; along each contact's own direction if `along_direction`, in z.
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  Eigen::Vector3d force_error = Eigen::Vector3d::Zero();  ///< [N] standard errors
  /// The forces were recorded along the direction of pressing only.
  bool along_direction = false;
  double touch = 0;  ///< [mm] mean of t over contacts on the surface
  /// [mm] its standard error as if the covariance of curves were known: if heights tell the
  /// touches, up to two times too small
  double touch_error = 0;
  double touch_spread = 0;  ///< [mm] standard deviation of t among contacts, beside its error
  /// Growth of t with `PressedContact::height`: 1 if the heights show the true touches.
  double height_slope = 0;
  double height_slope_error = 0;
  double hysteresis = 0;  ///< share of the force that is missing on the way back
  double hysteresis_error = 0;

  friend bool operator==(const PressingOffsets&, const PressingOffsets&) = default;
};

/// [mm] t that is expected of a contact before its forces are known.
[[nodiscard]] double expected_touch(const PressingOffsets& offsets, double height);

/// The force along the direction of pressing, F(z) = sum_k coefficients[k] z^(k + 1), z [mm] below
/// the true surface.
struct PressingCurve {
  Eigen::VectorXd coefficients;  ///< [N / mm^(k + 1)]
  double touch = 0;              ///< [mm] t of this contact
  double touch_error = 0;        ///< [mm] its standard deviation
  double reach = 0;              ///< [mm] deepest sample below the true surface
};
[[nodiscard]] double force_at(const PressingCurve& curve, double depth);

struct PressingEstimate {
  std::vector<PressingCurve> curves;  ///< of each contact
  PressingOffsets offsets;
  double force_noise = 0;  ///< [N] of each component: as given, or estimated
  bool noise_was_estimated = false;
  /// Force across the direction of pressing per displacement across, relative to the force along
  /// per displacement along, > 0: that of a half-space, unless contacts were pressed at an angle
  /// and resisted it.
  double lateral_ratio = 0;
  double lateral_ratio_error = 0;
  double length_scale = 0;  ///< [mm] over which stiffness changes along the surface
};

/// Ratio of tangential to normal stiffness of an elastic half-space, 2 (1 - nu) / (2 - nu), of a
/// material with Poisson's ratio 0.45, and its assumed standard deviation. The data of contacts
/// that were pressed at an angle replace it.
inline constexpr double kHalfSpaceRatio = 0.71, kHalfSpaceRatioError = 0.3;

/// Estimates the force of every contact as a function of depth, together for all contacts of an
/// acquisition (empirical Bayes): coefficients of the curves are a Gaussian process along the
/// surface (Matern 5/2 with a nugget), touches are normally distributed, and their covariances, the
/// length scale and the noise maximise the likelihood. The degree of the curves (1 to 4) and the
/// offsets are chosen by the Bayesian information criterion. Each curve follows from the data of
/// the contact and the 24 nearest ones. Does not depend on the world frame or, up to rounding, on
/// the order of contacts and samples.
/// \throws InvalidInput if there is no contact, a contact has no sample, sizes differ, a number is
/// not finite, or an option is outside its range.
[[nodiscard]] PressingEstimate estimate_pressing(std::span<const PressedContact> contacts,
                                                 const PressingOptions& options = {});

}  // namespace palpate::haptics
