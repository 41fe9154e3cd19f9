// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/campaign.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>
#include <utility>

#include "palpate/core/error.h"
#include "records/record_hash.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

constexpr int kPressing = -1;         // the normal force alone
constexpr double kUsualSeconds = 12;  // [s] of a trial (thesis 6.2.1), before one was performed
/// Tangential forces below this many standard deviations of the force are not tried.
constexpr double kSmallestForce = 2;
/// A second trial is made if the difference of coefficients that it resolves is at most this many
/// standard deviations of the current estimate.
constexpr double kCoarsest = 1;
constexpr double kForceTolerance = 5e-5;  // of a chosen force, relative to the largest

}  // namespace

struct Campaign::Impl {
  Impl(ContactPlan wanted, const CampaignOptions& with) : plan(std::move(wanted)), options(with) {
    if (options.strategy == TrialStrategy::adaptive) adaptive.emplace(plan, options);
  }

  // One direction at one level.
  struct Search {
    double low = 0, high = 0;  // [N] bisection: force that held; one that slipped, or the largest
    std::optional<long long> held = {};  // the trial that held `low`
    bool slipped = false;                // true if some force slipped
    int tries = 0;
  };

  [[nodiscard]] const Contact& here() const { return plan.contacts[contact]; }
  [[nodiscard]] double normal_force() const {
    return plan.normal_forces[static_cast<std::size_t>(level)];
  }
  /// [N] The largest tangential force that the arm may add.
  [[nodiscard]] double most_tangential() const {
    const double n = normal_force(), most = plan.options.max_force;
    return std::sqrt(std::max(most * most - n * n, 0.0));
  }
  [[nodiscard]] Vector3d unit_tangent() const {
    const double angle = direction_angle(plan.options, level, directions[direction]);
    const Eigen::Matrix3d frame = tangent_frame(here());
    return std::cos(angle) * frame.col(0) + std::sin(angle) * frame.col(1);
  }
  [[nodiscard]] Vector3d pressing() const { return -here().normal.normalized(); }

  void begin_contact() {
    level = 0;
    failures = 0;
    failed = false;
    if (contact >= plan.contacts.size()) return;
    posterior.emplace(pressing(), pooled_prior(cones, options.program.force_noise));
    begin_level();
  }

  void begin_level() {
    pressed = false;
    direction = 0;
    directions.resize(static_cast<std::size_t>(plan.options.directions));
    std::iota(directions.begin(), directions.end(), 0);
    // Fisher-Yates shuffle with numbers that depend only on the position in the campaign.
    RecordHash hash(options.seed);
    hash.add(here().id);
    hash.add(static_cast<std::uint64_t>(level));
    for (std::size_t i = directions.size(); i > 1; --i) {
      hash.add(static_cast<std::uint64_t>(i));
      std::swap(directions[i - 1],
                directions[static_cast<std::size_t>(hash.uniform() * static_cast<double>(i))]);
    }
    begin_direction();
  }

  void begin_direction() { search = {.high = most_tangential()}; }

  void next_direction() {
    ++direction;
    begin_direction();
  }

  void next_level() {
    if (++level < static_cast<int>(plan.normal_forces.size())) return begin_level();
    next_contact();
  }

  void next_contact() {
    cones.push_back(posterior->estimate());
    tallies.contacts_given_up += failed ? 1 : 0;
    ++contact;
    begin_contact();
  }

  /// [N] The tangential force that slips with this probability, or the largest possible one.
  [[nodiscard]] double force_for(double probability) const {
    const Vector3d along = unit_tangent(), normal = normal_force() * pressing();
    const double most = most_tangential();
    double low = 0, high = most;
    if (posterior->slip_probability(normal + high * along) <= probability) return high;
    while (high - low > kForceTolerance * most) {
      const double middle = (low + high) / 2;
      (posterior->slip_probability(normal + middle * along) < probability ? low : high) = middle;
    }
    return low;
  }

  /// [N] The tangential force to try now; none if the direction is done.
  [[nodiscard]] std::optional<double> tangential() const {
    const double least = kSmallestForce * options.program.force_noise;
    if (options.strategy == TrialStrategy::bisection) {
      if (search.high - search.low <= options.resolution) return std::nullopt;
      return (search.low + search.high) / 2;
    }
    if (search.tries == 0) {
      const double size = force_for(options.cautious);
      return size >= least ? std::optional(size) : std::nullopt;
    }
    if (search.tries > 1) return std::nullopt;
    if (search.slipped) {  // once more, with less
      const double size = std::min(force_for(options.cautious), search.high - least);
      return size >= least ? std::optional(size) : std::nullopt;
    }
    const ConeEstimate cone = posterior->estimate();
    if (cone.coefficient_error <= options.friction_accuracy) return std::nullopt;
    // The difference of coefficients that one trial resolves: large under a small normal force.
    const double told =
        options.program.force_noise * std::hypot(1, cone.coefficient) / normal_force();
    if (told > kCoarsest * cone.coefficient_error) return std::nullopt;
    const double size = force_for(1 - options.cautious);
    // A force that is not larger than one that held gives no information.
    return size >= search.low + least ? std::optional(size) : std::nullopt;
  }

  /// Chooses the next trial from the current state of the campaign.
  void decide() {
    choose();
    if (!order || order->direction == kPressing) return;
    order->slip_threshold = allowed_threshold(held_statistics);
    order->microslip = allowed_microslip(
        held_drags[order->contact.id], order->tangential_force.norm() / order->normal_force.norm());
  }

  void choose() {
    order.reset();
    if (adaptive) {
      order = adaptive->next();
      return;
    }
    while (contact < plan.contacts.size()) {
      TrialOrder next{.trial = tallies.trials,
                      .contact = here(),
                      .level = level,
                      .direction = kPressing,
                      .normal_force = normal_force() * pressing()};
      if (!pressed) {
        order = next;
        return;
      }
      if (direction >= directions.size()) {
        next_level();
        continue;
      }
      if (const std::optional<double> size = tangential()) {
        next.direction = directions[direction];
        next.tangential_force = *size * unit_tangent();
        order = next;
        return;
      }
      next_direction();
    }
  }

  void count(const TrialResult& result) {
    ++tallies.trials;
    tallies.seconds += result.seconds;
    if (sample_of(*order, result, 0)) {
      ++tallies.samples;
      tallies.slipped += result.outcome != TrialOutcome::held ? 1 : 0;
    }
  }

  TrialVerdict take(const TrialResult& result) {
    TrialVerdict verdict;
    count(result);
    if (order->direction != kPressing && result.outcome == TrialOutcome::held) {
      const ProgramOptions& program = options.program;
      const auto drag = held_drag(
          slip_trial(*order, result),
          {.position_deviation = program.position_noise, .force_deviation = program.force_noise});
      if (drag) held_drags[order->contact.id].push_back(*drag);
      held_statistics.push_back(result.slip_statistic);
    }
    if (adaptive) {
      TrialResult charged = result;  // with the time of the reference probe before it
      charged.seconds += std::exchange(reference_seconds, 0);
      const AdaptiveTrials::Taken taken = adaptive->take(charged);
      cones = adaptive->cones();
      decide();
      return {.on_boundary = taken.on_boundary, .contact_given_up = taken.contact_given_up};
    }
    const bool slipped =
        result.outcome == TrialOutcome::slipped || result.outcome == TrialOutcome::fell_off;
    if (!slipped && result.outcome != TrialOutcome::held) {
      if (++failures >= options.most_failures) {
        failed = verdict.contact_given_up = true;
        next_contact();
      } else if (pressed) {
        next_direction();
      }
      decide();
      return verdict;
    }
    failures = 0;
    if (options.strategy == TrialStrategy::pooled || order->direction == kPressing) {
      const ConeTrial trial{order->normal_force + order->tangential_force, slipped};
      if (order->direction != kPressing || slipped) posterior->add({&trial, 1});
    }
    if (order->direction == kPressing) {
      pressed = true;
      if (slipped) direction = directions.size();  // no tangential force can hold here
    } else {
      take_tangential(slipped, verdict);
    }
    decide();
    return verdict;
  }

  void take_tangential(bool slipped, TrialVerdict& verdict) {
    const double size = order->tangential_force.norm();
    ++search.tries;
    if (slipped) {
      search.slipped = true;
      search.high = std::min(search.high, size);
    } else {
      search.low = size;
      search.held = order->trial;
    }
    const bool known = options.strategy == TrialStrategy::bisection
                           ? search.high - search.low <= options.resolution
                           : true;
    if (known && search.slipped && search.held) verdict.on_boundary = search.held;
  }

  ContactPlan plan;
  CampaignOptions options;
  std::optional<AdaptiveTrials> adaptive;
  std::size_t contact = 0;
  int level = 0;
  bool pressed = false;  // at this level
  std::vector<int> directions;
  std::size_t direction = 0;  // index in `directions`
  Search search;
  int failures = 0;     // in succession
  bool failed = false;  // the contact
  std::optional<ConePosterior> posterior;
  std::vector<ConeEstimate> cones;
  std::map<long long, std::vector<HeldDrag>> held_drags;  // by the id of their contact
  std::vector<double> held_statistics;                    // T^2 of the drags that held
  CampaignProgress tallies;
  double reference_seconds = 0;  // since the latest trial
  std::optional<TrialOrder> order;
};

Campaign::Campaign(ContactPlan plan, const CampaignOptions& options) {
  check_campaign_options(options);
  if (plan.contacts.empty() || plan.normal_forces.empty())
    throw InvalidInput("Campaign: the plan has no contact or no level; plan at least one");
  impl_ = std::make_unique<Impl>(std::move(plan), options);
  if (!impl_->adaptive) impl_->begin_contact();
  impl_->decide();
}

Campaign::~Campaign() = default;
Campaign::Campaign(Campaign&&) noexcept = default;
Campaign& Campaign::operator=(Campaign&&) noexcept = default;

std::optional<TrialOrder> Campaign::next() const { return impl_->order; }
const ContactPlan& Campaign::plan() const { return impl_->plan; }
const std::vector<ConeEstimate>& Campaign::cones() const { return impl_->cones; }

TrialVerdict Campaign::take(const TrialRecord& record) {
  const std::optional<TrialOrder>& due = impl_->order;
  if (!due || record.order.trial != due->trial || record.order.contact.id != due->contact.id ||
      record.order.level != due->level || record.order.direction != due->direction ||
      record.order.normal_force != due->normal_force ||
      record.order.tangential_force != due->tangential_force) {
    throw InvalidInput("Campaign: trial " + std::to_string(record.order.trial) +
                       " is not the one that this plan and these options order next");
  }
  return impl_->take(record.result);
}

std::optional<TrialOrder> Campaign::reference() const {
  const Impl& at = *impl_;
  const int every = at.options.reference_every;
  if (every == 0 || !at.order || at.tallies.samples / every < at.tallies.references)
    return std::nullopt;
  return reference_order(at.plan, at.tallies.references);
}

void Campaign::take_reference(const ReferenceProbe& probe) {
  Impl& at = *impl_;
  if (!reference() || probe.number != at.tallies.references || probe.trials != at.tallies.trials) {
    throw InvalidInput("Campaign: reference probe " + std::to_string(probe.number) + " after " +
                       std::to_string(probe.trials) + " trials is not due");
  }
  ++at.tallies.references;
  at.tallies.seconds += probe.result.seconds;
  at.reference_seconds += probe.result.seconds;
}

CampaignProgress Campaign::progress() const {
  const Impl& at = *impl_;
  CampaignProgress progress = at.tallies;
  progress.contacts = static_cast<int>(at.plan.contacts.size());
  if (at.adaptive) {
    progress.contacts_done = at.adaptive->contacts_begun();
    progress.contacts_given_up = at.adaptive->contacts_given_up();
    progress.stated = at.adaptive->stated();
    progress.stop = at.adaptive->stop();
    progress.trials_left = at.adaptive->trials_left();
    progress.seconds_left =
        progress.trials_left *
        (progress.trials > 0 ? progress.seconds / progress.trials : kUsualSeconds);
    return progress;
  }
  progress.contacts_done = static_cast<int>(at.contact);
  // Trials of a contact: estimated from the options, or from the contacts before it.
  double of_contact = 0;
  for (const double normal : at.plan.normal_forces) {
    const double most =
        std::sqrt(std::max(std::pow(at.plan.options.max_force, 2) - normal * normal, 0.0));
    const double tries = at.options.strategy == TrialStrategy::bisection
                             ? std::max(0.0, std::ceil(std::log2(most / at.options.resolution)))
                             : 1.5;
    of_contact += 1 + (most > 0 ? at.plan.options.directions * tries : 0);
  }
  const double part =
      static_cast<double>(at.level) / static_cast<double>(at.plan.normal_forces.size());
  const double contacts_done = static_cast<double>(at.contact) + (at.order ? part : 0);
  if (at.contact > 0) of_contact = progress.trials / contacts_done;
  progress.trials_left = of_contact * (progress.contacts - contacts_done);
  progress.seconds_left =
      progress.trials_left *
      (progress.trials > 0 ? progress.seconds / progress.trials : kUsualSeconds);
  return progress;
}

}  // namespace palpate::probing
