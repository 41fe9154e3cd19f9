// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "peers.h"

namespace palpate::bench {

/// Measurements and truth at one contact.
struct ContactData {
  Eigen::Matrix3Xd displacements;        ///< [mm] 3 x N, measured
  Eigen::Matrix3Xd forces;               ///< [N] 3 x N, measured
  Eigen::Matrix3Xd truth_displacements;  ///< [mm] 3 x M, inside the friction cone
  Eigen::Matrix3Xd truth_forces;         ///< [N] 3 x M, without noise
};

/// A method that makes a force field from a contact's samples.
struct Method {
  std::string name;
  std::function<Predictor(const ContactData&)> fit;
};

/// Figures over all contacts of a set.
struct Figures {
  double training_rms = 0;  ///< [N] median over the contacts
  double truth_rms = 0;     ///< [N] median over the contacts
  double truth_rms_p90 = 0;
  /// [%] of the contacts where the work of pushing the tool straight from rest to some place within
  /// reach is negative.
  double not_passive = 0;
  /// [N mm] largest energy that a closed path through three places within reach gains or loses
  double loop_energy = 0;
  double numbers = 0;   ///< stored per contact, mean
  double fit_ms = 0;    ///< processor time per contact, median
  double force_us = 0;  ///< time of one evaluation, median over the contacts of the mean
};

/// The value below which this share of them is, the nearest of them.
[[nodiscard]] double quantile(std::vector<double> values, double share);

[[nodiscard]] Figures measure(const Method& method, const std::vector<ContactData>& contacts);

}  // namespace palpate::bench
