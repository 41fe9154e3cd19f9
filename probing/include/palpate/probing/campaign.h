// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "palpate/probing/adaptive_trials.h"
#include "palpate/probing/campaign_options.h"
#include "palpate/probing/cone_posterior.h"
#include "palpate/probing/contact_plan.h"
#include "palpate/probing/reference_probe.h"

namespace palpate::probing {

/// One trial as it was stored.
struct TrialRecord {
  TrialOrder order;
  TrialResult result;
};

/// The decisions after a trial, beside the next one.
struct TrialVerdict {
  /// The trial that held the largest tangential force of its direction and level, once it is known
  /// that a larger one slips: its sample lies on the friction boundary.
  std::optional<long long> on_boundary;
  bool contact_given_up = false;
};

struct CampaignProgress {
  int trials = 0;  ///< so far
  int samples = 0;
  int slipped = 0;        ///< of the samples
  int contacts_done = 0;  ///< given up or not
  int contacts_given_up = 0;
  int contacts = 0;
  int references = 0;                      ///< reference probes so far
  double seconds = 0;                      ///< of all trials and reference probes so far
  double trials_left = 0;                  ///< expected
  double seconds_left = 0;                 ///< expected
  StatedError stated = {};                 ///< `adaptive`
  AdaptiveStop stop = AdaptiveStop::none;  ///< `adaptive`: why it ended
};

/// Decides what to try next. The decisions are a function of the plan, the options and the records
/// it took: a campaign that takes the stored records of another continues as that one would.
///
/// `adaptive` is described with `AdaptiveTrials`. Otherwise contacts come in the order of the plan,
/// and at each one its levels ascend; each begins with the
/// normal force alone and goes through its directions in random order. With `bisection`, each
/// direction halves the interval from zero to sqrt(max_force^2 - normal^2). With `pooled`, each is
/// tried once with the force that slips with the probability `cautious`, as `ConePosterior` says
/// with the trials of this contact and a prior learnt at the contacts before it; see also
/// `friction_accuracy`.
class Campaign {
 public:
  /// \throws InvalidInput if an option is outside its range or of another strategy, or the plan has
  /// no contact.
  Campaign(ContactPlan plan, const CampaignOptions& options);
  ~Campaign();
  Campaign(Campaign&&) noexcept;
  Campaign& operator=(Campaign&&) noexcept;

  /// The next trial; none if the campaign is complete.
  [[nodiscard]] std::optional<TrialOrder> next() const;

  /// Takes the result of the trial that `next` ordered.
  /// \throws InvalidInput if the record is of another trial.
  TrialVerdict take(const TrialRecord& record);

  /// The reference probe that is due before `next`; none if none is.
  [[nodiscard]] std::optional<TrialOrder> reference() const;
  /// Takes what `reference` ordered. Only the time that it took counts for what comes next.
  /// \throws InvalidInput if it is not due.
  void take_reference(const ReferenceProbe& probe);

  [[nodiscard]] CampaignProgress progress() const;
  [[nodiscard]] const ContactPlan& plan() const;

  /// The friction cone at each contact that is done, by `ConePosterior` with the pooled prior.
  [[nodiscard]] const std::vector<ConeEstimate>& cones() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::probing
