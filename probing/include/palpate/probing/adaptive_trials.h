// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "palpate/probing/campaign_options.h"
#include "palpate/probing/cone_posterior.h"
#include "palpate/probing/contact_plan.h"
#include "palpate/probing/probing_program.h"

namespace palpate::probing {

/// [N] The five normal forces with which each contact begins: from the lowest to the highest level
/// of the plan in nearly even steps, a little denser below.
/// \throws InvalidInput if the plan has no level.
[[nodiscard]] std::vector<double> base_forces(const ContactPlan& plan);

enum class AdaptiveStop {
  none,         ///< not yet
  accurate,     ///< the stated error is at most `until`
  max_hours,    ///< no time for another trial
  max_samples,  ///< the largest number of samples was taken
  exhausted     ///< every contact of the plan has as many samples as are worth their time
};
/// "none", "accurate", "max_hours", "max_samples", "exhausted".
[[nodiscard]] const char* to_string(AdaptiveStop stop);

/// The accuracy that a campaign states of itself. Numbers are NaN until enough is known.
struct StatedError {
  double error = std::numeric_limits<double>::quiet_NaN();        ///< [N] of the model, RMS
  double at_contacts = std::numeric_limits<double>::quiet_NaN();  ///< [N] the part of noise
  /// [N] the part of the gaps; NaN until six contacts are enclosed by others, or all are begun, and
  /// if there is no more than one
  double between = std::numeric_limits<double>::quiet_NaN();
  /// [N] that this plan can be expected to reach at best
  double reachable = std::numeric_limits<double>::quiet_NaN();
  /// Ratio of the predicted to the actual errors of the samples before they were taken, by which
  /// `at_contacts` is corrected.
  double predicted_over_actual = std::numeric_limits<double>::quiet_NaN();
  int predictions = 0;
};

/// Chooses trials where they reduce the error of the model most per second.
///
/// Each contact begins with a base of five normal forces in nearly even steps, with the tangential
/// directions of the plan, at the force that slips with a probability of 5 %, or of `cautious`
/// where friction is not yet known. After that either the next contact of the plan is begun, or a
/// contact gets another trial: whichever reduces the stated error more per second. The benefit of a
/// trial is predicted by a `ForceSurrogate` of each contact; that of a contact is learnt by
/// predicting each contact from the others around it. The decisions are a function of the plan, the
/// options and the records it took.
class AdaptiveTrials {
 public:
  /// \param options whose strategy is `adaptive`, whatever they say
  /// \throws InvalidInput as `check_campaign_options`, or if the plan has no contact or no level.
  AdaptiveTrials(const ContactPlan& plan, const CampaignOptions& options);
  ~AdaptiveTrials();
  AdaptiveTrials(AdaptiveTrials&&) noexcept;
  AdaptiveTrials& operator=(AdaptiveTrials&&) noexcept;

  /// The next trial, numbered by those taken so far; none if the campaign has ended.
  [[nodiscard]] const std::optional<TrialOrder>& next() const;

  struct Taken {
    std::optional<long long> on_boundary;  ///< as `TrialVerdict`
    bool contact_given_up = false;
  };
  /// Takes the result of the trial that `next` ordered.
  Taken take(const TrialResult& result);

  [[nodiscard]] StatedError stated() const;
  [[nodiscard]] AdaptiveStop stop() const;
  [[nodiscard]] int contacts_begun() const;
  [[nodiscard]] int contacts_given_up() const;
  /// Expected until a limit.
  [[nodiscard]] double trials_left() const;
  /// The friction cone at each contact that was begun, in the order of the plan.
  [[nodiscard]] std::vector<ConeEstimate> cones() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::probing
