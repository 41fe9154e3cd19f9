// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "campaign/adaptive_site.h"

namespace palpate::probing {

/// Number of enclosed contacts from which on they alone give the error between contacts. Before, it
/// is stated only once all contacts were begun.
inline constexpr std::size_t kFewestContacts = 6;
/// The squared error between contacts falls with this power of their number, because the error
/// falls with the square of their distance.
inline constexpr double kGapPower = 2;

/// Comparison of samples with their predictions before they were taken.
class PredictionRecord {
 public:
  /// Compares a held trial with its prediction, once there is one.
  void judge(const AdaptiveSite& site, const Eigen::Vector3d& force,
             const Eigen::Vector3d& displacement);

  [[nodiscard]] int count() const { return count_; }
  /// Actual over predicted, of variances: as found, and shrunk towards 1 while there are few.
  [[nodiscard]] double found() const { return squared_ratios_ / count_; }
  [[nodiscard]] double correction() const;

 private:
  int count_ = 0;
  double squared_ratios_ = 0;
};

/// The parts of the expected squared error [N^2], and what they were learnt from. Contacts that are
/// not enclosed count for `between` until enough are.
struct ErrorParts {
  double at_contacts = 0, between = 0;
  double unexplained = 0;  ///< of `at_contacts`: more trials do not reduce it
  std::size_t contacts = 0, left_out = 0;
  std::size_t around = 0;  ///< contacts that are not enclosed
  double trials = 0;
};
[[nodiscard]] ErrorParts error_parts(const std::vector<AdaptiveSite>& sites,
                                     const PredictionRecord& record);

/// Returns the accuracy that a campaign states of itself.
[[nodiscard]] StatedError state_error(const std::vector<AdaptiveSite>& sites,
                                      const AdaptiveSetting& setting,
                                      const PredictionRecord& record);

}  // namespace palpate::probing
