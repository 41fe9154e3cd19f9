// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "build/pressing_rate.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "build/build_options.h"
#include "build/pressing_records.h"
#include "fit/pressing_field.h"
#include "palpate/core/error.h"
#include "palpate/core/parallel_for.h"
#include "palpate/core/quantile.h"
#include "palpate/haptics/rotation.h"

namespace palpate::haptics {
namespace {

constexpr double kLongGap = 10;  // median steps of a contact after which a new path begins
// Curves and rate are estimated in turn until the scale is 1 to the first of these and shares
// change by less than the second of themselves.
constexpr int kMostRounds = 8;
constexpr double kScaleAgrees = 3e-3, kSharesAgree = 0.02;

bool agree(const RateFit& fit, const RateFit& before) {
  if (fit.terms.size() != before.terms.size()) return false;
  if (!(std::abs(fit.scale - 1) <= kScaleAgrees)) return false;
  for (std::size_t i = 0; i < fit.terms.size(); ++i) {
    const double change = std::abs(fit.terms[i].share - before.terms[i].share);
    if (!(change <= kSharesAgree * before.terms[i].share)) return false;
  }
  return true;
}

}  // namespace

PressedPath pressed_path(long long contact, std::span<const probing::Sample> samples,
                         const Eigen::Matrix3Xd& displacements, const Eigen::Vector3d& direction) {
  PressedPath result;
  result.order.resize(samples.size());
  std::iota(result.order.begin(), result.order.end(), Eigen::Index{0});
  const auto time_of = [&](Eigen::Index i) { return samples[static_cast<std::size_t>(i)].time; };
  std::ranges::stable_sort(result.order, {}, time_of);
  result.path.displacements.resize(3, displacements.cols());
  std::vector<double> steps;
  for (std::size_t k = 0; k < result.order.size(); ++k) {
    result.path.time.push_back(time_of(result.order[k]));
    if (k == 0) continue;
    steps.push_back(result.path.time[k] - result.path.time[k - 1]);
    if (steps.back() > 0) continue;
    throw wrong_measurements(
        "samples of contact " + std::to_string(contact) +
        " have the same time, so that their rate is not known; give each its time");
  }
  const double longest = steps.empty() ? 0 : kLongGap * median(steps);
  bool outside = true;  // before
  for (std::size_t k = 0; k < result.order.size(); ++k) {
    const auto displacement = displacements.col(result.order[k]);
    const bool begins = outside || steps[k - 1] > longest;
    outside = !(displacement.dot(direction) > 0);
    result.path.begins.push_back(begins || outside);
    result.path.displacements.col(static_cast<Eigen::Index>(k)) =
        outside ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : Eigen::Vector3d(displacement);
  }
  return result;
}

Eigen::Matrix3Xd pressed_rate_forces(std::span<const RateTerm> terms, const ForceField& field,
                                     long long contact, std::span<const probing::Sample> samples,
                                     const Eigen::Matrix3Xd& displacements,
                                     const Eigen::Vector3d& direction) {
  const PressedPath ordered = pressed_path(contact, samples, displacements, direction);
  const Eigen::Matrix3Xd forces = rate_forces(terms, field, ordered.path);
  Eigen::Matrix3Xd result(3, forces.cols());
  for (std::size_t k = 0; k < ordered.order.size(); ++k)
    result.col(ordered.order[k]) = forces.col(static_cast<Eigen::Index>(k));
  return result;
}

PressedRate estimate_pressed_rate(const std::vector<PressedContact>& contacts,
                                  const std::vector<std::span<const probing::Sample>>& samples,
                                  const PressingOptions& options, int max_bases) {
  PressedRate result{
      .estimate = estimate_pressing(contacts, options), .contacts = contacts, .rate = {}};
  RateFit before;
  for (int round = 0; round < kMostRounds; ++round) {
    std::vector<RateRecord> records(contacts.size());
    std::vector<PressedPath> paths(contacts.size());
    std::vector<Eigen::Matrix3d> frames(contacts.size());
    PressingOffsets offsets = result.estimate.offsets;
    offsets.hysteresis = 0;  // it is what the rate is to explain
    parallel_for(contacts.size(), [&](std::size_t i) {
      const PressingCurve& curve = result.estimate.curves[i];
      frames[i] = rotation_between(Eigen::Vector3d::UnitZ(), contacts[i].direction);
      const ForceSamples given = corrected(contacts[i], offsets, curve.touch);
      paths[i] =
          pressed_path(samples[i].front().contact, samples[i],
                       frames[i].transpose() * given.displacements, Eigen::Vector3d::UnitZ());
      RateRecord& record = records[i];
      record.field = pressing_field(curve, result.estimate.lateral_ratio, max_bases);
      record.path = paths[i].path;
      record.forces.resize(3, given.forces.cols());
      for (std::size_t k = 0; k < paths[i].order.size(); ++k) {
        record.forces.col(static_cast<Eigen::Index>(k)) =
            frames[i].transpose() * given.forces.col(paths[i].order[k]);
      }
    });
    result.rate = fit_rate(records);
    if (result.rate.terms.empty()) {
      if (round > 0)
        result = {.estimate = estimate_pressing(contacts, options),
                  .contacts = contacts,
                  .rate = result.rate};
      return result;
    }
    parallel_for(contacts.size(), [&](std::size_t i) {
      const Eigen::Matrix3Xd added =
          frames[i] * result.rate.scale *
          rate_forces(result.rate.terms, records[i].field, records[i].path);
      PressedContact& still = result.contacts[i];
      still.unloading.clear();
      for (std::size_t k = 0; k < paths[i].order.size(); ++k) {
        still.forces.col(paths[i].order[k]) =
            contacts[i].forces.col(paths[i].order[k]) - added.col(static_cast<Eigen::Index>(k));
      }
    });
    result.estimate = estimate_pressing(result.contacts, options);
    if (agree(result.rate, before)) break;
    before = result.rate;
  }
  return result;
}

}  // namespace palpate::haptics
