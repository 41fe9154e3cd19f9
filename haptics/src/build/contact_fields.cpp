// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "build/contact_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "fit/field_objective.h"
#include "fit/left_out_pairs.h"
#include "fit/pressing_field.h"
#include "fit/unmeasured_directions.h"
#include "model/fit_misfit.h"
#include "palpate/core/error.h"
#include "palpate/core/parallel_for.h"
#include "palpate/haptics/rounding.h"

namespace palpate::haptics {
namespace {

constexpr double kGreatestFigure = 1e12;  // that a file may hold

// Limits a figure to the largest number. NaN: not known.
std::optional<double> storable(double figure) {
  if (std::isnan(figure)) return std::nullopt;
  return std::min(figure, kGreatestFigure);
}

FitResult fit_field(const ForceSamples& pairs, const std::optional<LocalPart>& local_part,
                    const FitOptions& options) {
  FitResult fit = local_part ? fit_with_local_part(pairs, *local_part, options).fit
                             : fit_force_field(pairs.displacements, pairs.forces, options);
  fit.field = rounded(std::move(fit.field));
  double sum = 0;
  for (Eigen::Index i = 0; i < pairs.forces.cols(); ++i)
    sum += (force(fit.field, pairs.displacements.col(i)) - pairs.forces.col(i)).squaredNorm();
  fit.rms = std::sqrt(sum / static_cast<double>(pairs.forces.cols()));
  return fit;
}

// Between its samples a field errs more than at them. If samples are few, the estimate of this
// growth is limited.
constexpr double kMostGrowth = 4;

// Errors of a fitted field: the effect of noise on its parameters, and what noise does not explain.
ContactUncertainty uncertainty_of(const FitResult& fit, double parameters, double pairs,
                                  const MeasurementNoise& noise) {
  const double share = std::min(1.0, parameters / (3 * pairs)) *
                       std::min(expected_growth(parameters, 3 * pairs), kMostGrowth);
  const double misfit = fit_misfit(std::min(fit.chi2, kGreatestFigure), fit.noise_floor, pairs);
  return {.force = std::sqrt(3 * share * noise.force * noise.force + misfit),
          .displacement = std::sqrt(share) * noise.displacement};
}

void take_fit(ContactModel& model, const ForceSamples& samples, const FitResult& fit) {
  model.samples = static_cast<int>(samples.forces.cols());
  model.rms = fit.rms;
  model.fit_stop = fit.stop;
  model.fit_mode = fit.mode;
  model.passivity = fit.certificate.passivity;
  model.chi2 = storable(fit.chi2);
  model.noise_floor = storable(fit.noise_floor);
  if (fit.condition) model.condition = storable(*fit.condition);
  model.shared_local = fit.shared_local;
  model.field = fit.field;
  model = rounded(std::move(model));
}

// Mean stiffness, relative to its trace, of the contacts that show all directions.
std::optional<Eigen::Matrix3d> expected_stiffness(const std::vector<ForceSamples>& samples,
                                                  const std::vector<ContactReport>& contacts,
                                                  const std::vector<bool>& measured) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!measured[i]) continue;
    Eigen::Matrix3d mean = Eigen::Matrix3d::Zero();
    for (const auto& x : samples[i].displacements.colwise())
      mean += stiffness(contacts[i].fit.field, x);
    if (mean.trace() > 0) sum += mean / mean.trace();
  }
  if (!(sum.trace() > 0)) return std::nullopt;
  return sum;
}

}  // namespace

void fit_fields(const std::vector<ForceSamples>& samples, const FitOptions& fit_options,
                const BuildOptions& options, BuildResult& result) {
  std::vector<bool> measured(samples.size(), true);
  std::vector<std::size_t> first, last;
  const double noise = fit_options.noise.displacement.value_or(kDisplacementNoise);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    measured[i] = unmeasured_directions(samples[i].displacements, samples[i].forces, noise,
                                        fit_options.noise.force)
                      .count == 0;
    const FitResult* known = options.known_fit ? options.known_fit(result.contacts[i].id) : nullptr;
    if (known)
      result.contacts[i].fit = *known;
    else
      (measured[i] ? first : last).push_back(i);
  }
  const auto count = static_cast<int>(samples.size());
  int done = count - static_cast<int>(first.size() + last.size());
  if (done > 0 && options.progress) options.progress(BuildStage::fields, done, count);
  if (options.dense_samples) {
    result.local_part =
        learn_local_part(samples, {.fit = fit_options, .dense_samples = *options.dense_samples});
  }
  std::mutex reporting;
  const auto fit_all = [&](const std::vector<std::size_t>& contacts, const FitOptions& with) {
    parallel_for(contacts.size(), [&](std::size_t u) {
      const std::size_t i = contacts[u];
      ContactReport& report = result.contacts[i];
      report.fit = fit_field(samples[i], measured[i] ? result.local_part : std::nullopt, with);
      const std::lock_guard lock(reporting);
      if (options.keep_fit) options.keep_fit(report.id, report.fit);
      if (options.progress) options.progress(BuildStage::fields, ++done, count);
    });
  };
  fit_all(first, fit_options);
  FitOptions with = fit_options;
  with.expected_stiffness = expected_stiffness(samples, result.contacts, measured);
  fit_all(last, with);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const FitResult& fit = result.contacts[i].fit;
    const double parameters = kBaseSize * static_cast<double>(fit.field.bases.size());
    ContactModel& model = result.model.contacts[i];
    model.uncertainty =
        uncertainty_of(fit, parameters, static_cast<double>(samples[i].forces.cols()),
                       {fit_options.noise.force, fit.displacement_noise});
    if (fit.unmeasured > 0) model.uncertainty->across = kHalfSpaceRatioError / kHalfSpaceRatio;
    take_fit(model, samples[i], fit);
  }
}

double along_pressing(const PressingEstimate& estimate) {
  return 1 / std::sqrt(1 + 2 * estimate.lateral_ratio * estimate.lateral_ratio);
}

void take_pressing(const std::vector<ForceSamples>& samples, const FitOptions& options,
                   BuildResult& result) {
  const PressingEstimate& estimate = *result.pressing;
  const int max_bases = options.max_bases.value_or(kMaxConvexBases);
  parallel_for(samples.size(), [&](std::size_t i) {
    const PressingCurve& curve = estimate.curves[i];
    FitOptions with = options;
    with.mode = FitMode::convex;
    with.noise = {.displacement = curve.touch_error, .force = estimate.force_noise};
    result.contacts[i].fit = assess_force_field(
        rounded(pressing_field(curve, estimate.lateral_ratio, max_bases)), samples[i].displacements,
        samples[i].forces, static_cast<int>(curve.coefficients.size()), with);
  });
  // The touch acts along the pressing only, through a part of the stiffness.
  const double along = along_pressing(estimate);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const PressingCurve& curve = estimate.curves[i];
    ContactModel& model = result.model.contacts[i];
    // Only what lies along the pressing counts, and the contacts around know most of it, too.
    const MeasurementNoise noise{.force = estimate.force_noise / std::sqrt(3.0)};
    model.uncertainty =
        uncertainty_of(result.contacts[i].fit, static_cast<double>(curve.coefficients.size()),
                       static_cast<double>(samples[i].forces.cols()), noise);
    model.uncertainty->force =
        std::hypot(model.uncertainty->force, estimate.offsets.force_error.norm() / std::sqrt(3.0));
    model.uncertainty->displacement = along * curve.touch_error;
    model.uncertainty->across =
        estimate.lateral_ratio > 0 ? estimate.lateral_ratio_error / estimate.lateral_ratio : 0;
    take_fit(model, samples[i], result.contacts[i].fit);
  }
}

void check_usable(const std::vector<ContactReport>& contacts) {
  constexpr std::size_t kNamed = 50;
  std::string named;
  std::size_t failed = 0;
  double worst = 0;
  for (const ContactReport& contact : contacts) {
    if (is_usable(contact)) continue;
    if (failed++ < kNamed) named += (named.empty() ? "" : ", ") + std::to_string(contact.id);
    if (!(contact.fit.rms <= worst)) worst = contact.fit.rms;
  }
  if (failed == 0) return;
  throw SolverError(fmt::format(
      "the fit failed at {} of {} contacts: its errors (RMS up to {:.4g} N) exceed the largest "
      "force that was measured there, so there is no model. Contacts: {}{}. Check their samples, "
      "or remove them.",
      failed, contacts.size(), worst, named, failed > kNamed ? ", ..." : ""));
}

void check_predictions(const std::vector<ForceSamples>& samples, const BuildResult& result) {
  constexpr double kMostOfLargest = 10;
  double largest = 0;
  for (const ForceSamples& contact : samples)
    largest = std::max(largest, contact.forces.colwise().norm().maxCoeff());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const ContactModel& contact = result.model.contacts[i];
    for (const auto& displacement : samples[i].displacements.colwise()) {
      const double predicted = force(contact.field, displacement).norm();
      if (predicted <= kMostOfLargest * largest) continue;
      throw SolverError(fmt::format(
          "the field of contact {} gives {:.4g} N at one of its own samples, where the largest "
          "force of all contacts is {:.4g} N, so there is no model. Check the positions and forces "
          "of this contact, or remove it.",
          contact.id, predicted, largest));
    }
  }
}

}  // namespace palpate::haptics
