// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/adaptive_trials.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "palpate/error.h"
#include "palpate/probing/force_surrogate.h"
#include "palpate/require.h"
#include "records/record_hash.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

constexpr double kHourSeconds = 3600;  // [s]

constexpr int kBaseLevels = 5;
/// Normal force = lowest + (highest - lowest) part^kLevelPower: nearly even, a little denser below.
constexpr double kLevelPower = 1.25;
/// Probability of slip of a trial that is not meant to search the friction cone.
constexpr double kHolding = 0.05;
constexpr double kHoldingDeviations = 1.645;  // normal quantile for that probability
/// Tangential forces below this many standard deviations of the force are not tried.
constexpr double kLeastTangential = 2;
constexpr double kForceStep = 1e-4;  // [N] of a chosen force

/// Further trials at a contact: directions in the tangent plane, and fractions of the largest
/// force.
constexpr int kFineDirections = 12;
constexpr std::array kParts = {1.0, 0.55};
/// Limit of the trials at a contact, in multiples of its base. More hardly help and slow down the
/// choice.
constexpr double kMostOfBase = 3;
constexpr int kQueriesPerContact = 20;
constexpr double kQueryLow = 0.1;     // [N] least force of a query
constexpr double kQueryInside = 0.9;  // of the friction cone

constexpr std::size_t kNeighbours = 6;
constexpr std::size_t kFewestContacts = 6;  // before the error between contacts is stated
/// Contacts whose normals differ by more than 60 degrees do not predict each other.
constexpr double kSameSide = 0.5;
/// A contact is enclosed iff the weighted mean of the vectors to its neighbours is at most this
/// fraction of their mean length.
constexpr double kEnclosed = 0.4;
constexpr double kPlaneRidge = 0.01;  // penalty of the plane's slopes, relative to its constant
/// Error at a place between contacts relative to that of predicting a left-out contact, which is
/// farther from the others. Fitted to the errors of `palpate fit` on the specimens that
/// docs/trade-probing.md names.
constexpr double kBetweenShare = 0.17;
/// The squared error between contacts falls with this power of their number, because the error
/// falls with the square of their distance.
constexpr double kGapPower = 2;
/// Number of pairs at a contact from which on its predictions count.
constexpr int kFewestToPredict = 8;
/// The stated error is assumed to be right with the weight of this many predictions.
constexpr double kAssumedPredictions = 10;
constexpr double kLargestRatio = 25;  // of squared errors; limits the effect of outliers

void check_adaptive_options(const AdaptiveOptions& options) {
  require("AdaptiveOptions::until", options.until, at_least(0).finite(), "N");
  require("AdaptiveOptions::max_hours", options.max_hours, at_least(0).finite(), "h");
  require("AdaptiveOptions::max_samples", options.max_samples, at_least(0));
  require("AdaptiveOptions::cautious", options.cautious, above(0).at_most(0.5));
  require("AdaptiveOptions::friction_accuracy", options.friction_accuracy, above(0).finite());
  require("AdaptiveOptions::most_failures", options.most_failures, above(0));
  if (options.until == 0 && options.max_hours == 0 && options.max_samples == 0) {
    throw InvalidInput(
        "AdaptiveOptions: there is no limit; give AdaptiveOptions::until, "
        "AdaptiveOptions::max_hours or AdaptiveOptions::max_samples");
  }
}

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

// State of a contact that was begun.
struct AdaptiveSite {
  std::size_t contact = 0;  // index in the plan
  std::optional<ConePosterior> posterior = {};
  ConeEstimate cone = {};
  std::vector<ForcePair> drags = {};
  std::array<ForcePair, kBaseLevels> pressed = {};  // mean of each level
  std::array<int, kBaseLevels> presses = {};
  int trials = 0;
  int failures = 0;  // in succession
  bool given_up = false, base_done = false;
  std::optional<ForceSurrogate> surrogate = {};
  std::vector<Vector3d> queries = {};
  double variance = 0;   // [N^2] expected squared error at the queries
  double left_out = -1;  // [N^2] squared error of its prediction by neighbours; < 0: none
  double gain = 0;       // [N^2] of the best further trial
  std::optional<TrialOrder> best = {};
};

struct AdaptiveTrials::Impl {
  Impl(const ContactPlan& with_plan, const AdaptiveOptions& with)
      : plan(with_plan), options(with), levels(base_forces(with_plan)) {
    decide();
  }

  [[nodiscard]] const Contact& contact_of(const AdaptiveSite& site) const {
    return plan.contacts[site.contact];
  }
  [[nodiscard]] Vector3d pressing(const AdaptiveSite& site) const {
    return -contact_of(site).normal.normalized();
  }
  [[nodiscard]] double most_tangential(double normal) const {
    const double most = plan.options.max_force;
    return std::sqrt(std::max(most * most - normal * normal, 0.0));
  }
  [[nodiscard]] Vector3d tangent(const AdaptiveSite& site, double angle) const {
    const Eigen::Matrix3d frame = tangent_frame(contact_of(site));
    return std::cos(angle) * frame.col(0) + std::sin(angle) * frame.col(1);
  }
  [[nodiscard]] double least_tangential() const {
    return kLeastTangential * options.program.force_noise;
  }
  [[nodiscard]] int base_size() const { return kBaseLevels * std::max(plan.options.directions, 1); }

  // [N] The tangential force along a unit vector that slips with this probability, or the largest
  // one.
  [[nodiscard]] double force_for(const AdaptiveSite& site, double normal, const Vector3d& along,
                                 double probability) const {
    const Vector3d pressed = normal * pressing(site);
    double low = 0, high = most_tangential(normal);
    if (site.posterior->slip_probability(pressed + high * along) <= probability) return high;
    while (high - low > kForceStep) {
      const double middle = (low + high) / 2;
      (site.posterior->slip_probability(pressed + middle * along) < probability ? low : high) =
          middle;
    }
    return low;
  }

  // [N] The largest tangential force that is held with the smallest plausible coefficient.
  [[nodiscard]] double surely_held(const AdaptiveSite& site, double normal,
                                   const Vector3d& along) const {
    const double coefficient =
        std::tan(std::max(site.cone.angle - kHoldingDeviations * site.cone.angle_deviation, 0.0));
    const auto holds = [&](double size) {
      const Vector3d force = normal * pressing(site) + size * along;
      const double inwards = force.dot(site.cone.axis);
      return (force - inwards * site.cone.axis).norm() <= coefficient * inwards;
    };
    double low = 0, high = most_tangential(normal);
    if (holds(high)) return high;
    while (high - low > kForceStep) {
      const double middle = (low + high) / 2;
      (holds(middle) ? low : high) = middle;
    }
    return low;
  }

  [[nodiscard]] TrialOrder order_of(const AdaptiveSite& site, int at_level, int along,
                                    const Vector3d& tangential) const {
    return {.trial = trials,
            .contact = contact_of(site),
            .level = at_level,
            .direction = along,
            .normal_force = levels[static_cast<std::size_t>(at_level)] * pressing(site),
            .tangential_force = tangential};
  }

  void begin_contact() {
    AdaptiveSite site{.contact = sites.size()};
    std::vector<ConeEstimate> known;
    for (const AdaptiveSite& each : sites) known.push_back(each.cone);
    site.posterior.emplace(pressing(site), pooled_prior(known, options.program.force_noise));
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
    directions.resize(static_cast<std::size_t>(plan.options.directions));
    std::iota(directions.begin(), directions.end(), 0);
    // Fisher-Yates shuffle with numbers that depend only on the position in the campaign.
    RecordHash hash(options.seed);
    hash.add(contact_of(sites[current]).id);
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
    while (!site.given_up && level < kBaseLevels) {
      const double normal = levels[static_cast<std::size_t>(level)];
      if (direction < directions.size()) {
        const int k = directions[direction];
        const Vector3d along = tangent(site, direction_angle(plan.options, level, k));
        // Error of the coefficient by one trial: large under a small normal force.
        const double told =
            options.program.force_noise * std::hypot(1, site.cone.coefficient) / normal;
        const bool search = site.cone.coefficient_error > options.friction_accuracy &&
                            told < site.cone.coefficient_error;
        double size = force_for(site, normal, along, search ? options.cautious : kHolding);
        if (slipped_at > 0) size = std::min(size, slipped_at - least_tangential());
        if (size >= least_tangential()) return order_of(site, level, k, size * along);
        next_direction();
        continue;
      }
      // If no tangential force can be tried, press with the normal force alone.
      if (site.presses[static_cast<std::size_t>(level)] == 0)
        return order_of(site, level, -1, Vector3d::Zero());
      next_level();
    }
    return std::nullopt;
  }

  [[nodiscard]] std::vector<ForcePair> pairs_of(const AdaptiveSite& site) const {
    std::vector<ForcePair> pairs = site.drags;
    for (std::size_t l = 0; l < site.presses.size(); ++l) {
      if (site.presses[l] > 0) pairs.push_back(site.pressed[l]);
    }
    return pairs;
  }

  void learn(AdaptiveSite& site) const {
    const std::vector<ForcePair> pairs = pairs_of(site);
    if (pairs.empty()) return;
    site.surrogate.emplace(pairs, SurrogateOptions{.position_noise = options.program.position_noise,
                                                   .force_noise = options.program.force_noise});
  }

  // Chooses forces at which the model should be right: evenly spaced in size, and spread evenly
  // over the section of the cone.
  void place_queries(AdaptiveSite& site) const {
    site.queries.clear();
    const Vector3d axis = site.cone.axis;
    // Define the axes by the tangent, so that the result does not depend on the frame.
    const Vector3d x = (tangent(site, 0) - tangent(site, 0).dot(axis) * axis).normalized();
    const Vector3d y = axis.cross(x);
    for (int i = 0; i < kQueriesPerContact; ++i) {
      const double part = (i + 0.5) / kQueriesPerContact;
      const double golden = std::fmod(i * std::numbers::phi, 1);
      const double ratio = kQueryInside * site.cone.coefficient * std::sqrt(golden);
      const double angle = 2 * std::numbers::pi * std::fmod(i * std::numbers::sqrt2, 1);
      const double size = kQueryLow + (plan.options.max_force - kQueryLow) * part;
      site.queries.push_back(
          size * (axis + ratio * (std::cos(angle) * x + std::sin(angle) * y)).normalized());
    }
  }

  // Updates the expected error of a contact, and its best further trial.
  void assess(AdaptiveSite& site) const {
    site.gain = 0;
    site.best.reset();
    if (!site.surrogate || site.given_up) return;
    if (site.queries.empty()) place_queries(site);
    site.variance = site.surrogate->error_variance(site.queries);
    if (site.trials >= kMostOfBase * base_size()) return;
    std::vector<TrialOrder> orders;
    std::vector<Vector3d> forces;
    std::vector<double> holds;
    for (int l = 0; l < kBaseLevels; ++l) {
      const double normal = levels[static_cast<std::size_t>(l)];
      for (int k = 0; k < kFineDirections; ++k) {
        const Vector3d along = tangent(site, 2 * std::numbers::pi * k / kFineDirections);
        const double most = surely_held(site, normal, along);
        for (std::size_t p = 0; p < kParts.size(); ++p) {
          if (kParts[p] * most < least_tangential()) continue;
          const int number = plan.options.directions + kFineDirections * static_cast<int>(p) + k;
          orders.push_back(order_of(site, l, number, kParts[p] * most * along));
          forces.push_back(orders.back().normal_force + orders.back().tangential_force);
          holds.push_back(p == 0 ? 1 - kHolding : 1);
        }
      }
    }
    const std::vector<double> gains = site.surrogate->reductions(site.queries, forces);
    for (std::size_t i = 0; i < gains.size(); ++i) {
      if (holds[i] * gains[i] > site.gain) {
        site.gain = holds[i] * gains[i];
        site.best = orders[i];
      }
    }
  }

  [[nodiscard]] static bool is_known(const AdaptiveSite& site) {
    return site.base_done && !site.given_up && site.surrogate.has_value();
  }

  // The known contacts nearest to a contact, without itself.
  [[nodiscard]] std::vector<std::pair<double, std::size_t>> neighbours_of(std::size_t index) const {
    std::vector<std::pair<double, std::size_t>> near;
    const Contact& here = contact_of(sites[index]);
    for (std::size_t i = 0; i < sites.size(); ++i) {
      const Contact& there = contact_of(sites[i]);
      if (i == index || !is_known(sites[i])) continue;
      if (here.normal.dot(there.normal) < kSameSide) continue;
      near.emplace_back((here.position - there.position).norm(), i);
    }
    std::sort(near.begin(), near.end());
    near.resize(std::min(near.size(), kNeighbours));
    return near;
  }

  // Predicts a contact from its neighbours by a local plane: least squares weighted by inverse
  // squared distances. Contacts at a border, which are predicted from one side, do not count.
  void leave_out(std::size_t index) {
    AdaptiveSite& site = sites[index];
    const auto near = neighbours_of(index);
    site.left_out = -1;
    if (near.size() < kNeighbours || !is_known(site)) return;
    const Contact& here = contact_of(site);
    const Eigen::Matrix3d frame = tangent_frame(here);
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Matrix3Xd rows(3, static_cast<Eigen::Index>(near.size()));
    Vector3d aside = Vector3d::Zero();
    double away = 0;
    for (std::size_t i = 0; i < near.size(); ++i) {
      const double distance = near[i].first, weight = 1 / (distance * distance);
      const Vector3d off = contact_of(sites[near[i].second]).position - here.position;
      const Vector3d row(1, off.dot(frame.col(0)) / near.back().first,
                         off.dot(frame.col(1)) / near.back().first);
      normal += weight * row * row.transpose();
      rows.col(static_cast<Eigen::Index>(i)) = weight * row;
      aside += weight * off;
      away += weight * distance;
    }
    if (aside.norm() > kEnclosed * away) return;
    normal.diagonal().tail<2>().array() += kPlaneRidge * normal(0, 0);
    const Eigen::VectorXd shares = (normal.inverse().row(0) * rows).transpose();
    double sum = 0;
    for (const Vector3d& query : site.queries) {
      Vector3d predicted = Vector3d::Zero();
      for (std::size_t i = 0; i < near.size(); ++i) {
        const AdaptiveSite& from = sites[near[i].second];
        const auto turn = Eigen::Quaterniond::FromTwoVectors(pressing(site), pressing(from));
        predicted += shares[static_cast<Eigen::Index>(i)] *
                     (turn.inverse() * from.surrogate->predict(turn * query).mean);
      }
      const Vector3d error = predicted - site.surrogate->predict(query).mean;
      sum += (site.surrogate->compliance(query).inverse() * error).squaredNorm();
    }
    site.left_out = sum / static_cast<double>(site.queries.size());
  }

  void finish_base() {
    AdaptiveSite& site = sites[current];
    if (!site.base_done) {
      site.base_done = true;
      place_queries(site);
      learn(site);
      assess(site);
      leave_out(current);
      for (std::size_t i = 0; i < sites.size(); ++i) {
        if (i == current) continue;
        const auto near = neighbours_of(i);
        const bool concerned = std::any_of(near.begin(), near.end(), [&](const auto& neighbour) {
          return neighbour.second == current;
        });
        if (concerned) leave_out(i);
      }
    }
  }

  [[nodiscard]] double correction() const {  // of variances
    return (squared_ratios + kAssumedPredictions) / (predictions + kAssumedPredictions);
  }

  struct Parts {
    double at_contacts = 0, between = 0;  // [N^2]
    std::size_t contacts = 0, left_out = 0;
    double trials = 0;
  };
  [[nodiscard]] Parts parts() const {
    Parts result;
    for (const AdaptiveSite& site : sites) {
      if (!is_known(site)) continue;
      result.at_contacts += site.variance;
      result.trials += site.trials;
      ++result.contacts;
      if (site.left_out >= 0) {
        result.between += kBetweenShare * kBetweenShare * site.left_out;
        ++result.left_out;
      }
    }
    if (result.contacts > 0)
      result.at_contacts *= correction() / static_cast<double>(result.contacts);
    if (result.left_out > 0) result.between /= static_cast<double>(result.left_out);
    return result;
  }

  [[nodiscard]] StatedError stated() const {
    StatedError result;
    result.predictions = predictions;
    if (predictions > 0) result.predicted_over_actual = 1 / std::sqrt(squared_ratios / predictions);
    const Parts at = parts();
    if (at.contacts == 0) return result;
    result.at_contacts = std::sqrt(at.at_contacts);
    if (at.left_out >= kFewestContacts) {
      result.between = std::sqrt(at.between);
      result.error = std::hypot(result.at_contacts, result.between);
    } else if (sites.size() == plan.contacts.size()) {
      result.error = result.at_contacts;  // too few contacts to estimate the error between them
    } else {
      return result;
    }
    const auto begun = static_cast<double>(at.contacts);
    const double fewer_gaps =
        std::pow(begun / static_cast<double>(plan.contacts.size()), kGapPower);
    const double more_trials = at.trials / begun / (kMostOfBase * base_size());
    result.reachable =
        std::sqrt(at.at_contacts * std::min(more_trials, 1.0) + at.between * fewer_gaps);
    return result;
  }

  [[nodiscard]] double seconds_per_trial() const {
    return trials > 0 ? seconds / static_cast<double>(trials) : 0;
  }

  // The limit that `further` trials would exceed, if any.
  [[nodiscard]] AdaptiveStop limit(int further) const {
    if (options.max_samples > 0 && samples + further > options.max_samples)
      return AdaptiveStop::max_samples;
    if (options.max_hours > 0 &&
        seconds + further * seconds_per_trial() > options.max_hours * kHourSeconds)
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
    if (options.until > 0 && stated().error <= options.until) return end(AdaptiveStop::accurate);
    const Parts at = parts();
    auto best = sites.end();
    for (auto site = sites.begin(); site != sites.end(); ++site) {
      if (site->best && (best == sites.end() || site->gain > best->gain)) best = site;
    }
    const bool more = sites.size() < plan.contacts.size();
    const bool fits = limit(base_size()) == AdaptiveStop::none;
    const bool few = at.left_out < kFewestContacts;
    // Compare the gain of one trial with that of another contact, per trial of its base.
    const double by_trial = best == sites.end() ? 0 : correction() * best->gain;
    const double by_contact = kGapPower * at.between / base_size();
    if (more && fits && (few || by_contact > by_trial)) {
      begin_contact();
      order = base_trial();
      if (order) return;
      return decide();  // nothing can be tried there
    }
    if (best != sites.end()) {
      current = static_cast<std::size_t>(best - sites.begin());
      order = best->best;
      order->trial = trials;
      return;
    }
    if (more && fits) {
      begin_contact();
      order = base_trial();
      if (order) return;
      return decide();
    }
    end(more ? limit(base_size()) : AdaptiveStop::exhausted);
  }

  // Compares a held trial with its prediction.
  void judge_prediction(const AdaptiveSite& site, const Vector3d& force,
                        const Vector3d& displacement) {
    if (!site.surrogate || !site.base_done ||
        static_cast<int>(site.drags.size()) < kFewestToPredict)
      return;
    const PredictedDisplacement expected = site.surrogate->predict(force);
    const Eigen::Matrix3d stiffness = site.surrogate->compliance(force).inverse();
    const double noise = site.surrogate->noise();
    const Eigen::Matrix3d covariance =
        expected.covariance + noise * noise * Eigen::Matrix3d::Identity();
    const double predicted = (stiffness * covariance * stiffness).trace();
    const double actual = (stiffness * (displacement - expected.mean)).squaredNorm();
    if (!(predicted > 0) || !std::isfinite(actual)) return;
    ++predictions;
    squared_ratios += std::min(actual / predicted, kLargestRatio);
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
      if (++site.failures >= options.most_failures) {
        site.given_up = taken.contact_given_up = true;
        site.base_done = true;
        site.best.reset();
      } else if (!site.base_done) {
        if (done.direction >= 0) next_direction();
      } else {
        ++site.trials;  // so that a trial which always fails ends
        assess(site);
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
      judge_prediction(site, force, result.b - done.contact.position);
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
      learn(site);
      assess(site);
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

  ContactPlan plan;
  AdaptiveOptions options;
  std::vector<double> levels;       // [N]
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
  int predictions = 0;
  double squared_ratios = 0;
  AdaptiveStop stop = AdaptiveStop::none;
  std::optional<TrialOrder> order;
};

AdaptiveTrials::AdaptiveTrials(const ContactPlan& plan, const AdaptiveOptions& options) {
  check_adaptive_options(options);
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
  double left = kMostOfBase * at.base_size() * static_cast<double>(at.plan.contacts.size()) -
                static_cast<double>(at.trials);
  if (at.options.max_samples > 0)
    left = std::min(left, static_cast<double>(at.options.max_samples - at.samples));
  if (at.options.max_hours > 0 && at.trials > 0) {
    left =
        std::min(left, (at.options.max_hours * kHourSeconds - at.seconds) / at.seconds_per_trial());
  }
  const double error = at.stated().error;
  if (at.options.until > 0 && std::isfinite(error)) {
    // If all of the error is noise, it falls with the root of the number of trials.
    const double times = std::pow(error / at.options.until, 2);
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
