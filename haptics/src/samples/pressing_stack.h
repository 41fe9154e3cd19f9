// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "palpate/haptics/pressing_estimate.h"
#include "samples/pressing_statistics.h"

namespace palpate::haptics {

/// Variation of the data of an acquisition along the surface.
struct Spatial {
  double length = 1;     // [mm]
  double nugget = 0;     // share of a coefficient's variance beside what varies smoothly
  double amplitude = 1;  // of the covariance of the population
  double touch_variance = 0;
};

/// The linearised contacts, with curves in units of their standard deviations over the object.
struct Neighbourhood {
  std::span<const PressedContact> contacts;
  std::vector<LinearPress> presses;
  std::vector<RowBlock> white;  // curve times a root of the covariance
  RowBlock root;                // of the covariance
  double noise_variance = 0;
};
[[nodiscard]] Neighbourhood neighbourhood_of(std::span<const CompressedPress> presses,
                                             std::span<const PressedContact> contacts,
                                             const PressingState& state);

/// Of the coefficients of two contacts.
[[nodiscard]] double correlation(const Neighbourhood& all, std::size_t i, std::size_t j,
                                 const Spatial& spatial);

/// Covariance of all data of some contacts, with their data and design.
struct Stack {
  Eigen::MatrixXd covariance, design;
  Eigen::VectorXd force;
  std::vector<Eigen::Index> begin;  // of each contact's rows, and the end
};
[[nodiscard]] Stack stack(const Neighbourhood& all, std::span<const std::size_t> members,
                          const Spatial& spatial);

/// Sums for generalised least squares, and -2 log likelihood without its constant.
struct Squares {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd vector;
  double fit = 0;

  Squares& operator+=(const Squares& other);
};

/// The data that all steps of the estimate along the surface need.
struct PressingData {
  std::span<const CompressedPress> presses;
  std::span<const PressedContact> contacts;
  double force_scale;
  const BiasInformation& bias;
};

/// -2 log likelihood, with the parameters that minimise it. `sum` is of the data alone.
[[nodiscard]] double profiled_loss(const PressingData& data, const PressingState& state,
                                   Squares sum);

/// The mean of tau, its slope, and the parameters, by generalised least squares with all data of
/// blocks of neighbouring contacts in one covariance. Each datum counts once, so that the errors
/// are those of the likelihood; only what distant contacts have in common counts as if it were
/// separate.
void fit_offsets(const PressingData& data, const Spatial& spatial, PressingState& state);
/// The parameters alone.
void fit_parameters(const PressingData& data, const Spatial& spatial, PressingState& state);

}  // namespace palpate::haptics
