// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/shared_local_part.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "fit/series_compliance.h"
#include "palpate/core/error.h"
#include "palpate/core/parallel_for.h"
#include "palpate/core/require.h"

namespace palpate::haptics {
namespace {

// The local part is shared if it reduces the mean log error by more than this many standard
// errors.
constexpr double kSignificance = 2;
// Alternations between l and the G_i. They start with linear compliances.
constexpr int kTurns = 3;
// Largest number of pairs for the fit of the local part. If there are more, an even selection is
// used, because more pairs cost time and add no information.
constexpr std::size_t kMostPairs = 1500;
// Largest number of dense contacts for the local part. They have more pairs than kMostPairs.
constexpr std::size_t kMostDense = 64;
// Largest number of dense contacts in the trial, and of its cross-validation folds.
constexpr std::size_t kMostTrials = 24;
constexpr std::size_t kMostFolds = 6;
// Number of forces at which a series is sampled, similar to the samples of a dense contact.
constexpr Eigen::Index kSeriesForces = 150;
// Noise assumed for the fit of a series, relative to that of the samples, as the series has none.
constexpr double kSeriesNoise = 0.5;
// Number of parameters of G.
constexpr int kGlobalParameters = 6;
// Standard deviation of an unknown compliance, relative to the compliance of the samples.
constexpr double kUnknown = 10;
// Folds of the cross-validation of a sparse contact's own fit. It needs at least as many pairs.
constexpr std::size_t kParts = 5;

using Contacts = std::vector<const ForceSamples*>;

// A single convex fit without alternatives, for computed pairs and for trials.
FitResult fit_once(const Eigen::Matrix3Xd& displacements, const Eigen::Matrix3Xd& forces,
                   FitOptions options) {
  options.try_certified = false;
  return fit_force_field(displacements, forces, options);
}

// Sort key of a pair.
std::array<double, 6> key(const ForceSamples& samples, Eigen::Index i) {
  const Eigen::Vector3d f = samples.forces.col(i), d = samples.displacements.col(i);
  return {f.x(), f.y(), f.z(), d.x(), d.y(), d.z()};
}

std::vector<Eigen::Index> ordered(const ForceSamples& samples) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(samples.forces.cols()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::ranges::sort(order, {}, [&](Eigen::Index i) { return key(samples, i); });
  return order;
}

// Sorts the pairs, so that sums round the same way whatever their input order.
ForceSamples in_order(const ForceSamples& samples) { return columns(samples, ordered(samples)); }

// Orders contacts by their number of pairs, most first, then by the sorted pairs.
bool comes_first(const ForceSamples& l, const ForceSamples& r) {
  if (l.forces.cols() != r.forces.cols()) return l.forces.cols() > r.forces.cols();
  for (Eigen::Index i = 0; i < l.forces.cols(); ++i) {
    if (key(l, i) != key(r, i)) return key(l, i) < key(r, i);
  }
  return false;
}

// An even selection of at most `most` elements.
template <typename Element>
std::vector<Element> some_of(const std::vector<Element>& all, std::size_t most) {
  if (all.size() <= most) return all;
  std::vector<Element> chosen;
  for (std::size_t i = 0; i < most; ++i) chosen.push_back(all[i * all.size() / most]);
  return chosen;
}

double rms(const Eigen::Matrix3Xd& columns) {
  return std::sqrt(columns.colwise().squaredNorm().mean());
}

// All pairs of some contacts, sorted.
ForceSamples pooled(const Contacts& contacts) {
  Eigen::Index count = 0;
  for (const ForceSamples* contact : contacts) count += contact->forces.cols();
  ForceSamples all;
  all.displacements.resize(3, count);
  all.forces.resize(3, count);
  Eigen::Index at = 0;
  for (const ForceSamples* contact : contacts) {
    all.displacements.middleCols(at, contact->forces.cols()) = contact->displacements;
    all.forces.middleCols(at, contact->forces.cols()) = contact->forces;
    at += contact->forces.cols();
  }
  return in_order(all);
}

// Compliance of the whole displacement at a contact.
Eigen::Matrix3d linear_compliance(const ForceSamples& samples, const FitNoise& noise) {
  const PairNoise pairs = pair_noise(samples, noise);
  const double largest = std::max(rms(samples.forces), pairs.force);
  const double size = std::max(rms(samples.displacements), pairs.displacement) / largest;
  return fit_global_compliance(samples, {}, {size * Eigen::Matrix3d::Identity(), kUnknown * size},
                               pairs, samples.forces);
}

// Options for fitting displacements as a function of forces, with the noises exchanged. The noise
// of the displacements also includes that of the forces, through the subtracted compliances.
FitOptions exchanged(const FitNoise& noise, const std::vector<Eigen::Matrix3d>& global) {
  double squares = 0;
  for (const Eigen::Matrix3d& compliance : global) squares += compliance.squaredNorm() / 3;
  squares /= static_cast<double>(global.size());
  FitOptions dual;
  dual.noise.force =
      std::hypot(noise.displacement.value_or(kDisplacementNoise), noise.force * std::sqrt(squares));
  dual.noise.displacement = noise.force;
  return dual;
}

ForceField fit_local_part(const Contacts& dense, const std::vector<Eigen::Matrix3d>& global,
                          const FitNoise& noise) {
  std::vector<ForceSamples> left;
  Contacts view;
  for (std::size_t i = 0; i < dense.size(); ++i) {
    left.push_back(*dense[i]);
    left.back().displacements -= global[i] * dense[i]->forces;
  }
  for (const ForceSamples& contact : left) view.push_back(&contact);
  ForceSamples all = pooled(view);
  std::vector<Eigen::Index> every(static_cast<std::size_t>(all.forces.cols()));
  std::iota(every.begin(), every.end(), Eigen::Index{0});
  all = columns(all, some_of(every, kMostPairs));
  return fit_once(all.forces, all.displacements, exchanged(noise, global)).field;
}

// Prior of G at other contacts.
CompliancePrior prior_of(const ForceField& local, const Eigen::Matrix3d& mean_global,
                         const Eigen::Matrix3Xd& forces) {
  Eigen::Matrix3d mean = mean_global;
  for (const auto& f : forces.colwise()) {
    mean += stiffness(local, f) / static_cast<double>(forces.cols());
  }
  return {mean_global, std::max(mean.norm(), std::numeric_limits<double>::min())};
}

// Learns the local part from dense contacts, without deciding whether to share it.
LocalPart learn(const Contacts& dense, const FitNoise& noise) {
  LocalPart part;
  part.noise = noise;
  part.forces = spread_columns(pooled(dense).forces, kSeriesForces);
  std::vector<Eigen::Matrix3d> global;
  for (const ForceSamples* contact : dense) global.push_back(linear_compliance(*contact, noise));
  const Eigen::Matrix3d stiffest = *std::ranges::min_element(
      global, {}, [](const Eigen::Matrix3d& compliance) { return compliance.trace(); });
  for (Eigen::Matrix3d& compliance : global) compliance -= stiffest;
  for (int turn = 0; turn < kTurns; ++turn) {
    part.local = fit_local_part(dense, global, noise);
    part.mean_global.setZero();
    for (const Eigen::Matrix3d& compliance : global) {
      part.mean_global += compliance / static_cast<double>(global.size());
    }
    const CompliancePrior prior = prior_of(part.local, part.mean_global, part.forces);
    part.mean_compliance = prior.deviation;
    for (std::size_t i = 0; i < dense.size(); ++i) {
      global[i] = fit_global_compliance(*dense[i], part.local, prior, pair_noise(*dense[i], noise),
                                        part.forces);
    }
  }
  return part;
}

Eigen::Matrix3d global_compliance(const ForceSamples& samples, const LocalPart& part) {
  return fit_global_compliance(samples, part.local, {part.mean_global, part.mean_compliance},
                               pair_noise(samples, part.noise), part.forces);
}

FitResult fit_series(const ForceSamples& samples, const Series& series, const LocalPart& part,
                     const FitOptions& options) {
  const Eigen::Index own = samples.forces.cols(), known = part.forces.cols();
  Eigen::Matrix3Xd forces(3, own + known), displacements(3, own + known);
  forces << samples.forces, part.forces;
  for (Eigen::Index i = 0; i < forces.cols(); ++i) {
    displacements.col(i) = series.displacement(forces.col(i));
  }
  FitOptions exact = options;
  exact.noise.displacement = kSeriesNoise * part.noise.displacement.value_or(kDisplacementNoise);
  exact.noise.force = kSeriesNoise * part.noise.force;
  const FitResult fit = fit_once(displacements, forces, exact);
  FitOptions measured = options;
  measured.noise = part.noise;
  FitResult result = assess_force_field(fit.field, samples.displacements, samples.forces,
                                        kGlobalParameters, measured);
  result.mode = fit.mode;
  result.certificate = fit.certificate;
  result.iterations = fit.iterations;
  result.condition = fit.condition;
  result.shared_local = true;
  return result;
}

// Error of a displacement, expressed as a force through the compliance.
double force_error(const Series& series, const ForceSamples& samples, Eigen::Index i) {
  const Eigen::Vector3d f = samples.forces.col(i);
  return series.compliance(f)
      .ldlt()
      .solve(samples.displacements.col(i) - series.displacement(f))
      .norm();
}

// Returns true if a fit to the contact's own pairs predicts held-out pairs better than the series.
// The errors are compared by their product, so that outliers do not decide. Pairs of about the same
// force are held out together, because any fit would interpolate between nearly equal pairs.
bool own_is_better(const ForceSamples& samples, const LocalPart& part, const FitOptions& options) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(samples.forces.cols()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::ranges::stable_sort(order, {}, [&](Eigen::Index i) { return samples.forces.col(i).norm(); });
  if (order.size() < kParts) return false;
  const double least = pair_noise(samples, part.noise).force;
  double gain = 0;
  for (std::size_t fold = 0; fold < kParts; ++fold) {
    std::vector<Eigen::Index> kept, held_out;
    for (std::size_t i = 0; i < order.size(); ++i) {
      (i * kParts / order.size() == fold ? held_out : kept).push_back(order[i]);
    }
    const ForceSamples rest = columns(samples, kept);
    const ForceField own = fit_once(rest.displacements, rest.forces, options).field;
    const Series series{part.local, global_compliance(rest, part)};
    for (const Eigen::Index i : held_out) {
      const double error =
          (force(own, samples.displacements.col(i)) - samples.forces.col(i)).norm();
      gain +=
          std::log(std::hypot(least, force_error(series, samples, i)) / std::hypot(least, error));
    }
  }
  return gain > 0;
}

double held_out_rms(const ForceField& field, const ForceSamples& samples) {
  double sum = 0;
  for (Eigen::Index i = 0; i < samples.forces.cols(); ++i) {
    sum += (force(field, samples.displacements.col(i)) - samples.forces.col(i)).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(samples.forces.cols()));
}

// log(error with the local part / error without) at a dense contact, on the pairs that are held out
// if only those with the forces nearest to a sparse contact's are known.
double gain_at(const ForceSamples& dense, const Eigen::Matrix3Xd& sparse_forces,
               const LocalPart& part, const FitOptions& options) {
  std::vector<bool> taken(static_cast<std::size_t>(dense.forces.cols()), false);
  for (const auto& wanted : sparse_forces.colwise()) {
    Eigen::Index nearest = 0;
    (dense.forces.colwise() - wanted).colwise().squaredNorm().minCoeff(&nearest);
    taken[static_cast<std::size_t>(nearest)] = true;
  }
  std::vector<Eigen::Index> kept, held_out;
  for (std::size_t i = 0; i < taken.size(); ++i) {
    (taken[i] ? kept : held_out).push_back(static_cast<Eigen::Index>(i));
  }
  const ForceSamples few = columns(dense, kept), others = columns(dense, held_out);
  const FitResult own = fit_once(few.displacements, few.forces, options);
  const SeriesFit series = fit_with_local_part(few, part, options);
  // Exact data can have zero error; keep the logarithm finite.
  const double least = std::numeric_limits<double>::min();
  return std::log(std::max(held_out_rms(series.fit.field, others), least)) -
         std::log(std::max(held_out_rms(own.field, others), least));
}

// Cross-validation: treats dense contacts as sparse, with the local part of the other contacts.
void try_sharing(const Contacts& dense, const Contacts& sparse, const FitOptions& options,
                 LocalPart& part) {
  const Contacts tried = some_of(dense, kMostTrials);
  const std::size_t folds = std::min(tried.size(), kMostFolds);
  std::vector<LocalPart> parts(folds);
  parallel_for(folds, [&](std::size_t fold) {
    Contacts others;
    for (const ForceSamples* contact : dense) {
      const auto place = std::ranges::find(tried, contact) - tried.begin();
      const bool left_out = static_cast<std::size_t>(place) < tried.size() &&
                            static_cast<std::size_t>(place) % folds == fold;
      if (!left_out) others.push_back(contact);
    }
    parts[fold] = learn(others, part.noise);
    parts[fold].outcome = SharingOutcome::shared;
    parts[fold].dense_samples = part.dense_samples;
  });
  Eigen::ArrayXd gains(static_cast<Eigen::Index>(tried.size()));
  parallel_for(tried.size(), [&](std::size_t i) {
    const ForceSamples& plan = *sparse[i * sparse.size() / tried.size()];
    gains[static_cast<Eigen::Index>(i)] =
        gain_at(*tried[i], plan.forces, parts[i % folds], options);
  });
  const auto count = static_cast<double>(tried.size());
  const double gain = gains.mean();
  const double error = std::sqrt((gains - gain).square().sum() / (count * (count - 1)));
  part.gain = gain;
  part.gain_error = error;
  part.outcome = gain < -kSignificance * error ? SharingOutcome::shared : SharingOutcome::no_gain;
}

void check(std::span<const ForceSamples> contacts, const LocalGlobalOptions& options) {
  require("LocalGlobalOptions::dense_samples", options.dense_samples,
          at_least(kFewestDenseSamples));
  if (contacts.empty()) {
    throw InvalidInput("learn_local_part(): there is no contact; give those of a whole object");
  }
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const ForceSamples& samples = contacts[i];
    if (samples.forces.cols() > 0 && samples.forces.cols() == samples.displacements.cols() &&
        samples.forces.allFinite() && samples.displacements.allFinite()) {
      continue;
    }
    throw InvalidInput("learn_local_part(): contact " + std::to_string(i) + " has " +
                       std::to_string(samples.displacements.cols()) + " displacements and " +
                       std::to_string(samples.forces.cols()) +
                       " forces; there must be as many of both, at least one, and all finite");
  }
}

}  // namespace

LocalPart learn_local_part(std::span<const ForceSamples> contacts,
                           const LocalGlobalOptions& options) {
  check(contacts, options);
  std::vector<ForceSamples> all;
  std::ranges::transform(contacts, std::back_inserter(all), in_order);
  std::ranges::sort(all, comes_first);
  Contacts dense, sparse;
  for (const ForceSamples& contact : all) {
    (contact.forces.cols() >= options.dense_samples ? dense : sparse).push_back(&contact);
  }
  // Use the same noise for all contacts, because few samples estimate it less well than all.
  FitOptions fit = options.fit;
  if (!fit.noise.displacement) {
    fit.noise.displacement = pooled_displacement_noise(all).value_or(kDisplacementNoise);
  }
  LocalPart part;
  const Contacts taught = some_of(dense, kMostDense);
  if (dense.size() >= static_cast<std::size_t>(kFewestDense) && !sparse.empty()) {
    part = learn(taught, fit.noise);
    part.outcome = SharingOutcome::no_gain;
  } else {
    part.outcome = sparse.empty() ? SharingOutcome::none_sparse : SharingOutcome::too_few_dense;
  }
  part.noise = fit.noise;
  part.dense_samples = options.dense_samples;
  part.dense = static_cast<int>(dense.size());
  part.sparse = static_cast<int>(sparse.size());
  if (!part.local.bases.empty()) try_sharing(taught, sparse, fit, part);
  return part;
}

SeriesFit fit_with_local_part(const ForceSamples& samples, const LocalPart& part,
                              const FitOptions& options) {
  FitOptions own = options;
  if (!own.noise.displacement) own.noise.displacement = part.noise.displacement;
  const bool sparse = samples.forces.cols() > 0 &&
                      samples.forces.cols() == samples.displacements.cols() &&
                      samples.forces.cols() < part.dense_samples && samples.forces.allFinite() &&
                      samples.displacements.allFinite();
  if (part.outcome == SharingOutcome::shared && sparse) {
    const ForceSamples pairs = in_order(samples);
    const Series series{part.local, global_compliance(pairs, part)};
    if (chi2(series, pairs, pair_noise(pairs, part.noise)) <= kMaxChi2 ||
        !own_is_better(pairs, part, own)) {
      return {fit_series(pairs, series, part, own), series.global};
    }
  }
  return {fit_force_field(samples.displacements, samples.forces, own), Eigen::Matrix3d::Zero()};
}

const char* to_string(SharingOutcome outcome) {
  switch (outcome) {
    case SharingOutcome::shared:
      return "shared";
    case SharingOutcome::no_gain:
      return "no_gain";
    case SharingOutcome::too_few_dense:
      return "too_few_dense";
    case SharingOutcome::none_sparse:
      return "none_sparse";
  }
  return "unknown";
}

}  // namespace palpate::haptics
