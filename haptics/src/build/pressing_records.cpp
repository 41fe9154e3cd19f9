// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "build/pressing_records.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>

#include "build/build_options.h"
#include "build/pressing_rate.h"
#include "fit/pressing_field.h"
#include "palpate/core/error.h"

namespace palpate::haptics {
namespace {

// Displacements lie along a line if the root mean square of what is beside it is at most this share
// of the deepest, and the line is at most this steep against the normal (a tangent, 45 degrees).
constexpr double kBesideLine = 0.1, kSteepestLine = 1;
// Largest share of contacts for which that does not hold.
constexpr double kFewExceptions = 0.1;
// The way back begins at the first record within this share of the deepest one.
constexpr double kDeepest = 0.02;
// Records after the deepest one are a way back if at least this share of them is less deep than the
// one before.
constexpr double kMostlyBack = 0.7;

// Marks the records of a contact on the way back; empty if none are or times are not known.
std::vector<bool> way_back(const Eigen::VectorXd& depth, std::span<const probing::Sample> samples) {
  std::vector<std::size_t> order(samples.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return samples[a].time < samples[b].time; });
  for (std::size_t k = 1; k < order.size(); ++k) {
    // One time for several records is no order.
    if (!(samples[order[k]].time > samples[order[k - 1]].time)) return {};
  }
  const auto depth_of = [&](std::size_t k) { return depth(static_cast<Eigen::Index>(order[k])); };
  const double deepest = depth.maxCoeff();
  std::size_t turn = 0;
  while (depth_of(turn) < (1 - kDeepest) * deepest) ++turn;
  std::size_t back = 0;
  for (std::size_t k = turn + 1; k < order.size(); ++k)
    back += depth_of(k) < depth_of(k - 1) ? 1 : 0;
  const std::size_t after = order.size() - turn - 1;
  if (after == 0 || static_cast<double>(back) < kMostlyBack * static_cast<double>(after)) return {};
  std::vector<bool> result(samples.size(), false);
  for (std::size_t k = turn + 1; k < order.size(); ++k) result[order[k]] = true;
  return result;
}

bool lies_along_line(const PressedContact& contact) {
  const Eigen::VectorXd depth = contact.displacements.transpose() * contact.direction;
  const double square = depth.squaredNorm();
  if (!(square > 0) || !(depth.maxCoeff() > 0)) return false;
  const Eigen::Vector3d slope = contact.displacements * depth / square - contact.direction;
  const Eigen::Matrix3Xd beside =
      contact.displacements - (slope + contact.direction) * depth.transpose();
  const double rms = std::sqrt(beside.squaredNorm() / static_cast<double>(depth.size()));
  return slope.norm() <= kSteepestLine && rms <= kBesideLine * depth.maxCoeff();
}

}  // namespace

PressedContact pressed_contact(const probing::Contact& contact,
                               std::span<const probing::Sample> samples, double height) {
  PressedContact result;
  result.position = contact.position;
  result.direction = -contact.normal.normalized();
  result.height = height;
  const auto count = static_cast<Eigen::Index>(samples.size());
  result.displacements.resize(3, count);
  result.forces.resize(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const probing::Sample& sample = samples[static_cast<std::size_t>(i)];
    result.displacements.col(i) = sample.b - contact.position;
    result.forces.col(i) = sample.force;
  }
  result.unloading = way_back(result.displacements.transpose() * result.direction, samples);
  return result;
}

bool is_pressing_only(const probing::CheckedAcquisition& acquisition,
                      std::span<const std::size_t> contacts) {
  std::size_t exceptions = 0;
  for (const std::size_t i : contacts) {
    const std::span<const probing::Sample> samples = acquisition.samples_of(i);
    for (const probing::Sample& sample : samples) {
      if (sample.slipped || sample.on_friction_boundary || sample.a != sample.b) return false;
    }
    if (!lies_along_line(pressed_contact(acquisition.contacts()[i], samples, 0))) ++exceptions;
  }
  return static_cast<double>(exceptions) <= kFewExceptions * static_cast<double>(contacts.size());
}

ForceSamples corrected(const PressedContact& contact, const PressingOffsets& offsets,
                       double touch) {
  const Eigen::Vector3d bias = offsets.along_direction
                                   ? Eigen::Vector3d(offsets.force.z() * contact.direction)
                                   : offsets.force;
  ForceSamples result;
  result.displacements = contact.displacements.colwise() + touch * contact.direction;
  result.forces = contact.forces.colwise() - bias;
  for (std::size_t i = 0; i < contact.unloading.size(); ++i) {
    if (contact.unloading[i])
      result.forces.col(static_cast<Eigen::Index>(i)) /= 1 - offsets.hysteresis;
  }
  result.kinds.assign(static_cast<std::size_t>(result.forces.cols()), PairKind::settled);
  return result;
}

Pairs pressed_pairs(const Probed& probed, const BuildOptions& options) {
  const std::optional<int> max_bases = fit_options(options).max_bases;
  if (max_bases && *max_bases < kFewestPressingBases) {
    throw InvalidInput(std::vector<MessagePart>{
        {"BuildOptions::max_bases", true},
        {fmt::format(" is {}; where all contacts were only pressed, it must be at least {}",
                     *max_bases, kFewestPressingBases)}});
  }
  std::vector<PressedContact> contacts;
  for (std::size_t i = 0; i < probed.size(); ++i)
    contacts.push_back(pressed_contact(probed.contact(i), probed.samples(i), probed.heights[i]));
  PressingOptions with{.estimate_offsets = options.estimate_offsets};
  if (options.force_noise && *options.force_noise > 0) with.force_noise = options.force_noise;
  Pairs pairs;
  if (options.rate) {
    std::vector<std::span<const probing::Sample>> records;
    for (std::size_t i = 0; i < probed.size(); ++i) records.push_back(probed.samples(i));
    PressedRate found =
        estimate_pressed_rate(contacts, records, with, max_bases.value_or(kMaxConvexBases));
    pairs.pressing = std::move(found.estimate);
    pairs.rate = std::move(found.rate);
    contacts = std::move(found.contacts);
  } else {
    pairs.pressing = estimate_pressing(contacts, with);
  }
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    pairs.samples.push_back(
        corrected(contacts[i], pairs.pressing->offsets, pairs.pressing->curves[i].touch));
  }
  return pairs;
}

}  // namespace palpate::haptics
