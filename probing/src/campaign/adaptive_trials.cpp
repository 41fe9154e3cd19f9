// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/adaptive_trials.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "campaign/adaptive_site.h"
#include "campaign/error_statement.h"
#include "campaign/neighbour_prediction.h"
#include "campaign/tangential_force.h"
#include "palpate/core/error.h"
#include "records/record_hash.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

constexpr double kHourSeconds = 3600;  // [s]

/// Normal force = lowest + (highest - lowest) part^kLevelPower: nearly even, a little denser below.
constexpr double kLevelPower = 1.25;

}  // namespace

std::vector<double> base_forces(const ContactPlan& plan) {
  if (plan.normal_forces.empty())
    throw InvalidInput(
        "base_forces(): the plan has no level of the normal force; plan at least one");
  const double low = plan.normal_forces.front(), high = plan.normal_forces.back();
  std::vector<double> forces;
  for (int l = 0; l < kBaseLevels; ++l) {
    const double part = static_cast<double>(l) / static_cast<double>(kBaseLevels - 1);
    forces.push_back(low + (high - low) * std::pow(part, kLevelPower));
  }
  return forces;
}

const char* to_string(AdaptiveStop stop) {
  switch (stop) {
    case AdaptiveStop::none:
      return "none";
    case AdaptiveStop::accurate:
      return "accurate";
    case AdaptiveStop::max_hours:
      return "max_hours";
    case AdaptiveStop::max_samples:
      return "max_samples";
    case AdaptiveStop::exhausted:
      return "exhausted";
  }
  return "";
}

struct AdaptiveTrials::Impl {
  Impl(const ContactPlan& plan, const CampaignOptions& with)
      : setting{plan, with, base_forces(plan)} {
    decide();
  }

  void begin_contact() {
    AdaptiveSite site{.contact = setting.plan.contacts[sites.size()]};
    std::vector<ConeEstimate> known;
    for (const AdaptiveSite& each : sites) known.push_back(each.cone);
    site.posterior.emplace(site.pressing(),
                           pooled_prior(known, setting.options.program.force_noise));
    site.cone = site.posterior->estimate();
    sites.push_back(std::move(site));
    current = sites.size() - 1;
    level = -1;
    next_level();
  }

  void next_level() {
    ++level;
    direction = 0;
    retried = false;
    slipped_at = 0;
    directions.resize(static_cast<std::size_t>(setting.plan.options.directions));
    std::iota(directions.begin(), directions.end(), 0);
    // Fisher-Yates shuffle with numbers that depend only on the position in the campaign.
    RecordHash hash(setting.options.seed);
    hash.add(sites[current].contact.id);
    hash.add(static_cast<std::uint64_t>(level));
    for (std::size_t i = directions.size(); i > 1; --i) {
      hash.add(static_cast<std::uint64_t>(i));
      std::swap(directions[i - 1],
                directions[static_cast<std::size_t>(hash.uniform() * static_cast<double>(i))]);
    }
  }

  void next_direction() {
    ++direction;
    retried = false;
    slipped_at = 0;
  }

  // The next trial of the base of the current contact; none if the base is complete.
  [[nodiscard]] std::optional<TrialOrder> base_trial() {
    AdaptiveSite& site = sites[current];
    const CampaignOptions& options = setting.options;
    while (!site.given_up && level < kBaseLevels) {
      const double normal = setting.levels[static_cast<std::size_t>(level)];
      if (direction < directions.size()) {
        const int k = directions[direction];
        const Vector3d along = site.tangent(direction_angle(setting.plan.options, level, k));
        // Error of the coefficient by one trial: large under a small normal force.
        const double told =
            options.program.force_noise * std::hypot(1, site.cone.coefficient) / normal;
        const bool search = site.cone.coefficient_error > options.friction_accuracy &&
                            told < site.cone.coefficient_error;
        const double least = setting.least_tangential();
        double size = force_for(site, setting, normal, along, search ? options.cautious : kHolding);
        if (slipped_at > 0) size = std::min(size, slipped_at - least);
        if (size >= least) return ordered(order_at(site, setting, level, k, size * along));
        next_direction();
        continue;
      }
      // If no tangential force can be tried, press with the normal force alone.
      if (site.presses[static_cast<std::size_t>(level)] == 0)
        return ordered(order_at(site, setting, level, -1, Vector3d::Zero()));
      next_level();
    }
    return std::nullopt;
  }

  [[nodiscard]] TrialOrder ordered(TrialOrder trial) const {
    trial.trial = trials;
    return trial;
  }

  void finish_base() {
    AdaptiveSite& site = sites[current];
    if (!site.base_done) {
      site.base_done = true;
      place_queries(site, setting);
      learn(site, setting);
      assess(site, setting);
      leave_out(sites, current);
      for (std::size_t i = 0; i < sites.size(); ++i) {
        if (i == current) continue;
        const auto near = neighbours_of(sites, i);
        const bool concerned = std::any_of(near.begin(), near.end(), [&](const auto& neighbour) {
          return neighbour.second == current;
        });
        if (concerned) leave_out(sites, i);
      }
    }
  }

  [[nodiscard]] StatedError stated() const { return state_error(sites, setting, predictions); }

  [[nodiscard]] double seconds_per_trial() const {
    return trials > 0 ? seconds / static_cast<double>(trials) : 0;
  }

  // The limit that `further` trials would exceed, if any.
  [[nodiscard]] AdaptiveStop limit(int further) const {
    if (setting.options.max_samples > 0 && samples + further > setting.options.max_samples)
      return AdaptiveStop::max_samples;
    if (setting.options.max_hours > 0 &&
        seconds + further * seconds_per_trial() > setting.options.max_hours * kHourSeconds)
      return AdaptiveStop::max_hours;
    return AdaptiveStop::none;
  }

  void end(AdaptiveStop why) {
    stop = why;
    order.reset();
  }

  // Chooses the next trial from the current state of the campaign.
  void decide() {
    order.reset();
    if (limit(1) != AdaptiveStop::none) return end(limit(1));
    if (!sites.empty() && !sites[current].base_done) {
      order = base_trial();
      if (order) return;
      finish_base();
    }
    if (setting.options.until > 0 && stated().error <= setting.options.until)
      return end(AdaptiveStop::accurate);
    const ErrorParts at = error_parts(sites, predictions);
    auto best = sites.end();
    for (auto site = sites.begin(); site != sites.end(); ++site) {
      if (site->best && (best == sites.end() || site->gain > best->gain)) best = site;
    }
    const bool more = sites.size() < setting.plan.contacts.size();
    const bool fits = limit(setting.base_size()) == AdaptiveStop::none;
    const bool few = at.left_out < kFewestContacts;
    // Compare the gain of one trial with that of another contact, per trial of its base.
    const double by_trial = best == sites.end() ? 0 : predictions.correction() * best->gain;
    const double by_contact = kGapPower * at.between / setting.base_size();
    if (more && fits && (few || by_contact > by_trial)) {
      begin_contact();
      order = base_trial();
      if (order) return;
      return decide();  // nothing can be tried there
    }
    if (best != sites.end()) {
      current = static_cast<std::size_t>(best - sites.begin());
      order = ordered(*best->best);
      return;
    }
    if (more && fits) {
      begin_contact();
      order = base_trial();
      if (order) return;
      return decide();
    }
    end(more ? limit(setting.base_size()) : AdaptiveStop::exhausted);
  }

  Taken take(const TrialResult& result) {
    Taken taken;
    AdaptiveSite& site = sites[current];
    const TrialOrder done = *order;
    ++trials;
    seconds += result.seconds;
    if (sample_of(done, result, 0)) ++samples;
    const bool slipped =
        result.outcome == TrialOutcome::slipped || result.outcome == TrialOutcome::fell_off;
    if (!slipped && result.outcome != TrialOutcome::held) {
      if (++site.failures >= setting.options.most_failures) {
        site.given_up = taken.contact_given_up = true;
        site.base_done = true;
        site.best.reset();
      } else if (!site.base_done) {
        if (done.direction >= 0) next_direction();
      } else {
        ++site.trials;  // so that a trial which always fails ends
        assess(site, setting);
      }
      decide();
      return taken;
    }
    site.failures = 0;
    ++site.trials;
    const Vector3d force = done.normal_force + done.tangential_force;
    if (done.direction >= 0 || slipped) {
      const ConeTrial trial{force, slipped};
      site.posterior->add({&trial, 1});
      site.cone = site.posterior->estimate();
    }
    if (!slipped && done.direction >= 0)
      predictions.judge(site, force, result.b - done.contact.position);
    const auto l = static_cast<std::size_t>(done.level);
    if (result.a.allFinite()) {
      const double count = ++site.presses[l];
      const Vector3d at = result.a - done.contact.position;
      site.pressed[l].force = done.normal_force;
      site.pressed[l].displacement += (at - site.pressed[l].displacement) / count;
    }
    if (!slipped && done.direction >= 0)
      site.drags.push_back({force, result.b - done.contact.position});
    if (site.base_done) {
      learn(site, setting);
      assess(site, setting);
    } else if (done.direction < 0) {
      next_level();
    } else {
      take_base(done, slipped, taken);
    }
    decide();
    return taken;
  }

  void take_base(const TrialOrder& done, bool slipped, Taken& taken) {
    if (slipped && !retried) {
      retried = true;
      slipped_at = done.tangential_force.norm();
      return;
    }
    if (!slipped && retried) taken.on_boundary = done.trial;
    next_direction();
  }

  AdaptiveSetting setting;
  std::vector<AdaptiveSite> sites;  // in the order of the plan
  std::size_t current = 0;          // of the order
  int level = 0;
  std::size_t direction = 0;  // index in `directions`
  std::vector<int> directions;
  bool retried = false;
  double slipped_at = 0;  // [N] in this direction; 0: nowhere
  long long trials = 0;
  int samples = 0;
  double seconds = 0;
  PredictionRecord predictions;
  AdaptiveStop stop = AdaptiveStop::none;
  std::optional<TrialOrder> order;
};

AdaptiveTrials::AdaptiveTrials(const ContactPlan& plan, const CampaignOptions& given) {
  CampaignOptions options = given;
  options.strategy = TrialStrategy::adaptive;
  check_campaign_options(options);
  if (plan.contacts.empty() || plan.normal_forces.empty())
    throw InvalidInput("AdaptiveTrials: the plan has no contact or no level; plan at least one");
  impl_ = std::make_unique<Impl>(plan, options);
}
AdaptiveTrials::~AdaptiveTrials() = default;
AdaptiveTrials::AdaptiveTrials(AdaptiveTrials&&) noexcept = default;
AdaptiveTrials& AdaptiveTrials::operator=(AdaptiveTrials&&) noexcept = default;

const std::optional<TrialOrder>& AdaptiveTrials::next() const { return impl_->order; }
AdaptiveTrials::Taken AdaptiveTrials::take(const TrialResult& result) {
  if (!impl_->order) throw InvalidInput("AdaptiveTrials: the campaign has ended");
  return impl_->take(result);
}
StatedError AdaptiveTrials::stated() const { return impl_->stated(); }
AdaptiveStop AdaptiveTrials::stop() const { return impl_->stop; }
int AdaptiveTrials::contacts_begun() const { return static_cast<int>(impl_->sites.size()); }

int AdaptiveTrials::contacts_given_up() const {
  return static_cast<int>(std::count_if(impl_->sites.begin(), impl_->sites.end(),
                                        [](const AdaptiveSite& site) { return site.given_up; }));
}

double AdaptiveTrials::trials_left() const {
  const Impl& at = *impl_;
  if (!at.order) return 0;
  double left =
      kMostOfBase * at.setting.base_size() * static_cast<double>(at.setting.plan.contacts.size()) -
      static_cast<double>(at.trials);
  if (at.setting.options.max_samples > 0)
    left = std::min(left, static_cast<double>(at.setting.options.max_samples - at.samples));
  if (at.setting.options.max_hours > 0 && at.trials > 0) {
    left = std::min(
        left, (at.setting.options.max_hours * kHourSeconds - at.seconds) / at.seconds_per_trial());
  }
  const double error = at.stated().error;
  if (at.setting.options.until > 0 && std::isfinite(error)) {
    // If all of the error is noise, it falls with the root of the number of trials.
    const double times = std::pow(error / at.setting.options.until, 2);
    left = std::min(left, static_cast<double>(at.trials) * (times - 1));
  }
  return std::max(left, 0.0);
}

std::vector<ConeEstimate> AdaptiveTrials::cones() const {
  std::vector<ConeEstimate> cones;
  for (const AdaptiveSite& site : impl_->sites) cones.push_back(site.cone);
  return cones;
}

}  // namespace palpate::probing
