// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "model/field_warp.h"
#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// The kriged value of a contact: with the rule `compliances`, its compliance, in its pressing
/// frame. With `forces` its strength, in its local frame, as a compliance of which only u_z
/// varies.
[[nodiscard]] std::optional<Compliance> kriged_value(const ContactModel& contact, BlendRule rule);
[[nodiscard]] Eigen::Matrix3d kriged_frame(const ContactModel& contact, BlendRule rule);

/// Contacts with a known value around a place.
struct Surroundings {
  std::vector<int> contacts;
  Eigen::Matrix2Xd places;  ///< [mm] relative to the place, along its frame's x and y axes
  /// Values of the contacts, rotated into the place's frame (`turn_between`).
  Eigen::Matrix<double, 6, Eigen::Dynamic> values;
};

/// For each contact, the contacts that share a triangle of contacts or a vertex of the surface's
/// weights with it, ascending.
[[nodiscard]] std::vector<std::vector<int>> contact_neighbours(const Model& model);

/// Up to kMaxSurroundings contacts with a value for the model's rule: the nearest of those given,
/// their neighbours, and the neighbours of these. `excluded` (or -1) is left out.
[[nodiscard]] Surroundings surroundings(const Model& model,
                                        const std::vector<std::vector<int>>& neighbours,
                                        std::vector<int> from, const Eigen::Vector3d& place,
                                        const Eigen::Matrix3d& frame, int excluded);
inline constexpr std::size_t kMaxSurroundings = 32;

/// Covariance of compliances along the surface: amplitude^2 (matern(|whiten (x - y)|) + nugget
/// [x = y]).
struct Covariance {
  Eigen::Matrix2d whiten = Eigen::Matrix2d::Identity();  ///< [1/mm]
  double nugget = 0;                                     ///< > 0
  Compliance amplitude = Compliance::Zero();  ///< standard deviations, of each of the six
};

/// The maximum likelihood covariance, with amplitudes only of values that vary. `spacing` [mm] > 0:
/// typical distance of neighbours.
[[nodiscard]] Covariance learn_covariance(const std::vector<Surroundings>& around,
                                          const std::vector<Compliance>& values, double spacing);

/// Data for kriging along a model's surface what its rule needs.
struct ComplianceKriging {
  std::vector<std::vector<int>> neighbours;  ///< of each contact
  std::vector<int> known;                    ///< contacts with a value that have others around them
  std::vector<Surroundings> around;          ///< of each of `known`
  double spacing = 0;  ///< [mm] median distance of those to the nearest one; 0 if none
  Covariance covariance;
};
[[nodiscard]] ComplianceKriging learn_kriging(const Model& model);

struct KrigingPrediction {
  Compliance value;
  double variance = 0;  ///< relative to the square of the amplitude
};
/// Predicts the compliance at the centre of `around`. Precondition: at least one contact.
[[nodiscard]] KrigingPrediction predict_compliance(const Surroundings& around,
                                                   const Covariance& covariance);

/// Precision of stored derivatives: a trend is only an estimate.
inline constexpr int kTrendDigits = 5;
/// Reach of a trend relative to the spacing of contacts; further out a trend is meaningless.
inline constexpr double kReachRatio = 2;

/// Derivatives of the kriging of `around`, including the value at the place itself: 6 x 5 as in
/// `ContactCompliance`; zero without contacts around.
[[nodiscard]] Eigen::Matrix<double, 6, 5> kriging_trend(const Surroundings& around,
                                                        const Compliance& value,
                                                        const Covariance& covariance);

}  // namespace palpate::haptics
