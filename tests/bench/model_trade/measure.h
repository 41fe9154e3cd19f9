// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "peers.h"

namespace palpate::bench {

/// What was measured at one contact, and what is true there.
struct ContactData {
  Eigen::Matrix3Xd displacements;        ///< [mm] 3 x N, measured
  Eigen::Matrix3Xd forces;               ///< [N] 3 x N, measured
  Eigen::Matrix3Xd truth_displacements;  ///< [mm] 3 x M, inside the friction cone
  Eigen::Matrix3Xd truth_forces;         ///< [N] 3 x M, without noise
};

/// One way to make a force field of a contact's samples.
struct Method {
  std::string name;
  std::function<Predictor(const ContactData&)> fit;
};

/// Figures over all contacts of a set.
struct Figures {
  double training_rms = 0;  ///< [N] median over the contacts
  double truth_rms = 0;     ///< [N] median over the contacts
  double truth_rms_p90 = 0;
  /// [%] of the contacts: the work of pushing the tool straight from rest to somewhere in reach is
  /// negative
  double not_passive = 0;
  /// [N mm] the most that a closed way through three places in reach gives or takes, largest
  double loop_energy = 0;
  double numbers = 0;   ///< stored a contact, mean
  double fit_ms = 0;    ///< processor time a contact, median
  double force_us = 0;  ///< of one evaluation, median over the contacts of the mean
};

[[nodiscard]] Figures measure(const Method& method, const std::vector<ContactData>& contacts);

}  // namespace palpate::bench
