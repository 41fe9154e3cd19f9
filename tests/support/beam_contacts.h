// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <vector>

#include "beam_acquisition.h"
#include "palpate/haptics/force_field.h"
#include "palpate/haptics/realignment.h"

namespace palpate::haptics {

inline ForceSamples turned(ForceSamples samples, const Eigen::Matrix3d& rotation) {
  samples.displacements = rotation * samples.displacements;
  samples.forces = rotation * samples.forces;
  return samples;
}

/// Measurements of a sparse probing at each place, in its frame.
template <typename Object>
std::vector<ForceSamples> sparse_samples(const Object& object,
                                         const std::vector<Eigen::Vector2d>& places,
                                         support::StripProbing probing, double ratio) {
  std::vector<ForceSamples> result;
  for (const Eigen::Vector2d& at : places) {
    probing::Acquisition acquisition;
    support::ObjectProbe<Object>(object, probing)
        .probe_sparsely(acquisition, at.x(), at.y(), ratio);
    ++probing.seed;
    result.push_back(turned(realign(acquisition.contacts[0], acquisition.samples),
                            frame_at(object, at.x(), at.y())));
  }
  return result;
}

/// Settings for probing contacts densely and sparsely.
struct SparseProbing {
  support::StripProbing dense;
  support::StripProbing sparse{.normal_forces = {0.8, 2.4}, .directions = 4, .seed = 101};
  double ratio = 0.5;  ///< tangential over normal force at sparsely probed contacts
};

/// Measurements at contacts of an object, in their frames, with the truth.
struct ProbedContacts {
  std::vector<ForceSamples> dense, sparse, truth;
};

/// Probes each place both ways.
template <typename Object>
ProbedContacts probed_contacts(const Object& object, const std::vector<Eigen::Vector2d>& places,
                               SparseProbing probing = {}) {
  constexpr int kTruths = 100;
  ProbedContacts result;
  result.sparse = sparse_samples(object, places, probing.sparse, probing.ratio);
  for (const Eigen::Vector2d& at : places) {
    const Eigen::Matrix3d frame = frame_at(object, at.x(), at.y());
    probing::Acquisition dense;
    support::ObjectProbe<Object>(object, probing.dense).probe(dense, at.x(), at.y());
    ++probing.dense.seed;
    result.dense.push_back(turned(realign(dense.contacts[0], dense.samples), frame));
    ForceSamples truth;
    truth.displacements.resize(3, kTruths);
    truth.forces.resize(3, kTruths);
    Eigen::Index column = 0;
    for (const auto& pair : support::strip_truths(object, {at}, kTruths, probing.dense.seed)) {
      truth.displacements.col(column) = pair.displacement;
      truth.forces.col(column++) = pair.force;
    }
    result.truth.push_back(turned(truth, frame));
  }
  return result;
}

/// [N] root mean square of the error in force.
inline double rms_error(const ForceField& field, const ForceSamples& pairs) {
  double sum = 0;
  for (Eigen::Index i = 0; i < pairs.forces.cols(); ++i) {
    sum += (force(field, pairs.displacements.col(i)) - pairs.forces.col(i)).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(pairs.forces.cols()));
}

}  // namespace palpate::haptics
