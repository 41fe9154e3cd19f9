// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "model/field_warp.h"
#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// Contacts with a compliance around a place.
struct Surroundings {
  std::vector<int> contacts;
  Eigen::Matrix2Xd places;  ///< [mm] from there, along the x and y axes of the place's frame
  /// Compliances of the contacts, turned into the place's frame (`turn_between`).
  Eigen::Matrix<double, 6, Eigen::Dynamic> values;
};

/// Which contacts have one another around them: sharing a triangle of contacts or a vertex of the
/// surface's weights. By contact, ascending.
[[nodiscard]] std::vector<std::vector<int>> contact_neighbours(const Model& model);

/// Up to kMaxSurroundings contacts with a compliance: the nearest of those given, their neighbours
/// and theirs. `excluded` (or -1) is left out.
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

/// The most likely covariance; amplitudes only of what varies. `spacing` [mm] > 0: typical distance
/// of neighbours.
[[nodiscard]] Covariance learn_covariance(const std::vector<Surroundings>& around,
                                          const std::vector<Compliance>& values, double spacing);

/// What is known of a model's compliances along its surface.
struct ComplianceKriging {
  std::vector<std::vector<int>> neighbours;  ///< of each contact
  std::vector<int> known;            ///< contacts that have a compliance, and others around them
  std::vector<Surroundings> around;  ///< of each of `known`
  double spacing = 0;                ///< [mm] median distance of those to the nearest one; 0 = none
  Covariance covariance;
};
[[nodiscard]] ComplianceKriging learn_kriging(const Model& model);

struct KrigingPrediction {
  Compliance value;
  double variance = 0;  ///< relative to the square of the amplitude
};
/// Predicts the compliance at the place that `around` is around. Pre: at least one contact.
[[nodiscard]] KrigingPrediction predict_compliance(const Surroundings& around,
                                                   const Covariance& covariance);

/// Derivatives of the kriging of `around` together with the value at the place itself: 6 x 5 as in
/// `ContactCompliance`; zero without contacts around.
[[nodiscard]] Eigen::Matrix<double, 6, 5> kriging_trend(const Surroundings& around,
                                                        const Compliance& value,
                                                        const Covariance& covariance);

}  // namespace palpate::haptics
