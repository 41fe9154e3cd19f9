// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "build/uncertainty.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "build/left_out_blend.h"
#include "model/force_variance.h"
#include "palpate/core/parallel_for.h"
#include "palpate/core/quantile.h"
#include "palpate/haptics/blended_field.h"
#include "palpate/haptics/rounding.h"

namespace palpate::haptics {
namespace {

// The errors relative to the force, at the distance of left-out contacts, among which the
// most likely is chosen: 0, and kTried between these, in equal ratios.
constexpr double kLeastBetween = 1e-3, kMostBetween = 10;
constexpr int kTried = 33;
// Assumed standard deviation, among places, of the logarithm of the part between contacts: it
// differs by a factor of two.
const double kSpread = std::log(2);
constexpr int kBetweenDigits = 3;

// The whole is multiplied by what predicts contacts best whose own errors did not serve: one of
// kScales between 1 / kMostScale and kMostScale, in equal ratios.
constexpr double kMostScale = 4;
constexpr int kScales = 41;

using Losses = Eigen::Vector<double, kTried + 1>;
using ScaleLosses = Eigen::Vector<double, kScales>;

struct LeftOutErrors {
  std::vector<double> squares, known, unit;  // [N^2] of each sample
  double reach = 0;                          // [mm^2] as in `ForceVariance`
  geometry::ContactWeights from;             // the contacts that predict
};

LeftOutErrors left_out_errors(const Model& model, const BlendedField& field, const Blend& at,
                              std::size_t contact, const ForceSamples& samples,
                              const MeasurementNoise& noise) {
  const ContactModel& self = model.contacts[contact];
  LeftOutErrors result;
  result.from = at.contacts;
  for (Eigen::Index j = 0; j < samples.forces.cols(); ++j) {
    const Eigen::Vector3d displacement = self.frame * samples.displacements.col(j);
    const Eigen::Vector3d error =
        field.force(at, displacement) - self.frame * samples.forces.col(j);
    const ForceVariance parts = force_variance(model.contacts, at, self.position, displacement);
    result.squares.push_back(error.squaredNorm());
    result.known.push_back(parts.contacts + parts.contrast +
                           noise_variance(noise, field.stiffness(at, displacement)));
    result.unit.push_back(parts.distance);
    result.reach = parts.reach;
  }
  return result;
}

// -2 log likelihood of the errors at a contact for each value that is tried. They are not
// independent of each other; together they count as one.
template <typename Values>
Values losses_of(const LeftOutErrors& errors, const Values& tried) {
  Values sum = Values::Zero();
  for (std::size_t j = 0; j < errors.squares.size(); ++j) {
    for (Eigen::Index t = 0; t < tried.size(); ++t) {
      const double variance = errors.known[j] + tried(t) * tried(t) * errors.unit[j];
      if (variance > 0) sum(t) += std::log(variance) + errors.squares[j] / variance;
    }
  }
  return sum / static_cast<double>(errors.squares.size());
}

template <typename Values>
Eigen::Index most_likely(const Values& losses) {
  Eigen::Index index = 0;
  losses.minCoeff(&index);
  return index;
}

// Estimates `between` from the errors of left-out contacts.
struct BetweenSearch {
  Losses tried;
  std::vector<Losses> losses;  // of each contact
  Losses all;                  // their sum
  std::vector<std::vector<int>> neighbours;

  // Most likely at a contact, by its errors and those of its neighbours, of which one may be left
  // out.
  [[nodiscard]] double at(std::size_t contact, std::optional<std::size_t> without = {}) const {
    const Eigen::Index typical = most_likely(without ? Losses(all - losses[*without]) : all);
    // The first value, 0, counts as one step below the next.
    const double step = std::log(kMostBetween / kLeastBetween) / (kTried - 1);
    Losses here;
    for (Eigen::Index t = 0; t < here.size(); ++t)
      here(t) = std::pow(step * static_cast<double>(t - typical) / kSpread, 2);
    if (contact != without) here += losses[contact];
    for (const int other : neighbours[contact]) {
      const auto index = static_cast<std::size_t>(other);
      if (index != without) here += losses[index];
    }
    return tried(most_likely(here));
  }
};

// Values learnt from a contact and its neighbours fit their errors better than those of others.
// Each contact is therefore judged here by values learnt without it.
double out_of_sample_scale(const std::vector<std::optional<LeftOutErrors>>& errors,
                           const BetweenSearch& search) {
  ScaleLosses scales;
  for (int s = 0; s < kScales; ++s) scales(s) = std::pow(kMostScale, 2 * s / (kScales - 1.0) - 1);
  std::vector<ScaleLosses> losses(errors.size(), ScaleLosses::Zero());
  parallel_for(errors.size(), [&](std::size_t i) {
    if (!errors[i]) return;
    double square = 0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(errors[i]->from.count); ++k) {
      const auto other = static_cast<std::size_t>(errors[i]->from.contacts[k]);
      square += errors[i]->from.weights[k] * std::pow(search.at(other, i), 2);
    }
    losses[i] = losses_of(*errors[i], ScaleLosses(std::sqrt(square) * scales));
  });
  ScaleLosses sum = ScaleLosses::Zero();
  for (const ScaleLosses& of_contact : losses) sum += of_contact;
  return scales(most_likely(sum));
}

}  // namespace

double noise_variance(const MeasurementNoise& noise, const Eigen::Matrix3d& stiffness) {
  return 3 * noise.force * noise.force +
         noise.displacement * noise.displacement * stiffness.squaredNorm();
}

Model with_uncertainty(Model model, std::span<const ForceSamples> samples,
                       const MeasurementNoise& noise) {
  model.noise = MeasurementNoise{round_to_digits(noise.force, kNoiseDigits),
                                 round_to_digits(noise.displacement, kNoiseDigits)};
  const LeftOutBlends blends(model);
  const BlendedField field(model);
  std::vector<std::optional<LeftOutErrors>> errors(model.contacts.size());
  parallel_for(model.contacts.size(), [&](std::size_t i) {
    if (const std::optional<Blend> at = blends.at(i))
      errors[i] = left_out_errors(model, field, *at, i, samples[i], noise);
  });
  std::vector<double> reaches;
  for (const std::optional<LeftOutErrors>& of_contact : errors)
    if (of_contact && of_contact->reach > 0) reaches.push_back(of_contact->reach);
  if (reaches.empty()) {
    for (ContactModel& contact : model.contacts) contact.uncertainty.reset();
    return model;
  }
  const double unit = 1 / std::sqrt(geometry::error_growth(median(reaches)));
  BetweenSearch search{.tried = Losses::Zero(),
                       .losses = std::vector<Losses>(errors.size(), Losses::Zero()),
                       .all = Losses::Zero(),
                       .neighbours = blends.neighbours()};
  for (int t = 0; t < kTried; ++t)
    search.tried(t + 1) =
        unit * kLeastBetween * std::pow(kMostBetween / kLeastBetween, t / (kTried - 1.0));
  parallel_for(errors.size(), [&](std::size_t i) {
    if (errors[i]) search.losses[i] = losses_of(*errors[i], search.tried);
  });
  for (const Losses& of_contact : search.losses) search.all += of_contact;
  const double scale = out_of_sample_scale(errors, search);
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (!model.contacts[i].uncertainty) continue;
    model.contacts[i].uncertainty->between = round_to_digits(scale * search.at(i), kBetweenDigits);
  }
  return model;
}

}  // namespace palpate::haptics
