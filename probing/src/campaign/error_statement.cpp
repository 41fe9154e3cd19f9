// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "campaign/error_statement.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace palpate::probing {
namespace {

/// Error at a place between contacts relative to that of predicting a left-out contact, which is
/// farther from the others. Fitted to the errors of `palpate fit` on the specimens that
/// docs/trade-probing.md names.
constexpr double kBetweenShare = 0.17;
/// Number of pairs at a contact from which on its predictions count.
constexpr int kFewestToPredict = 8;
/// The stated error is assumed to be right with the weight of this many predictions.
constexpr double kAssumedPredictions = 10;
/// Squared error of queries, relative to that of pairs that are left out. Pairs lie at the edge of
/// the measured range, queries inside. Measured on a ball that sticks: 0.36 with 23 pairs, 0.66
/// with 57.
constexpr double kInsideShare = 0.5;
constexpr double kLargestRatio = 25;  // of squared errors; limits the effect of outliers

}  // namespace

void PredictionRecord::judge(const AdaptiveSite& site, const Eigen::Vector3d& force,
                             const Eigen::Vector3d& displacement) {
  if (!site.surrogate || !site.base_done || static_cast<int>(site.drags.size()) < kFewestToPredict)
    return;
  const PredictedDisplacement expected = site.surrogate->predict(force);
  const Eigen::Matrix3d stiffness = site.surrogate->compliance(force).inverse();
  const double noise = site.surrogate->noise();
  const Eigen::Matrix3d covariance =
      expected.covariance + noise * noise * Eigen::Matrix3d::Identity();
  const double predicted = (stiffness * covariance * stiffness).trace();
  const double actual = (stiffness * (displacement - expected.mean)).squaredNorm();
  if (!(predicted > 0) || !std::isfinite(actual)) return;
  ++count_;
  squared_ratios_ += std::min(actual / predicted, kLargestRatio);
}

double PredictionRecord::correction() const {
  return (squared_ratios_ + kAssumedPredictions) / (count_ + kAssumedPredictions);
}

ErrorParts error_parts(const std::vector<AdaptiveSite>& sites, const PredictionRecord& record) {
  ErrorParts result;
  double around = 0;
  for (const AdaptiveSite& site : sites) {
    if (!site.is_known()) continue;
    result.at_contacts += site.variance;
    result.unexplained += site.unexplained;
    result.trials += site.trials;
    ++result.contacts;
    if (site.left_out >= 0) {
      result.between += kBetweenShare * kBetweenShare * site.left_out;
      ++result.left_out;
    } else if (site.around >= 0) {
      around += site.around;
      ++result.around;
    }
  }
  if (result.contacts > 0) {
    const auto contacts = static_cast<double>(result.contacts);
    const double expected = result.at_contacts / contacts;
    const double corrected = expected * record.correction();
    // Samples that were predicted before they were taken show what no energy explains, too, but
    // pairs that are left out show it from the first contact on. It must not count twice.
    result.unexplained = kInsideShare * std::max(result.unexplained / contacts, 0.0);
    result.at_contacts = std::max(corrected, expected + result.unexplained);
  }
  const bool few = result.left_out < kFewestContacts;
  if (few) result.between += around;
  const std::size_t judged = result.left_out + (few ? result.around : 0);
  if (judged > 0) result.between /= static_cast<double>(judged);
  return result;
}

StatedError state_error(const std::vector<AdaptiveSite>& sites, const AdaptiveSetting& setting,
                        const PredictionRecord& record) {
  StatedError result;
  result.predictions = record.count();
  if (record.count() > 0) result.predicted_over_actual = 1 / std::sqrt(record.found());
  const ErrorParts at = error_parts(sites, record);
  if (at.contacts == 0) return result;
  result.at_contacts = std::sqrt(at.at_contacts);
  const bool all_begun = sites.size() == setting.plan.contacts.size();
  if (at.left_out >= kFewestContacts || (all_begun && at.left_out + at.around > 1)) {
    result.between = std::sqrt(at.between);
    result.error = std::hypot(result.at_contacts, result.between);
  } else if (all_begun) {
    result.error = result.at_contacts;  // no other contact gives information on the gaps
  } else {
    return result;
  }
  const auto begun = static_cast<double>(at.contacts);
  const double fewer_gaps =
      std::pow(begun / static_cast<double>(setting.plan.contacts.size()), kGapPower);
  const double more_trials = at.trials / begun / (kMostOfBase * setting.base_size());
  const double reducible = std::max(at.at_contacts - at.unexplained, 0.0);
  result.reachable =
      std::sqrt(reducible * std::min(more_trials, 1.0) + at.unexplained + at.between * fewer_gaps);
  return result;
}

}  // namespace palpate::probing
