// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "plain_process.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace palpate::bench {
namespace {

using Eigen::Vector3d;

constexpr double kPlaceLength = 20;       // [mm] when choosing
constexpr double kForceLength = 1.0 / 3;  // of the largest force, when choosing
constexpr int kCandidatesPerContact = 60;
constexpr double kCandidateInside = 0.9;     // of the friction cone
constexpr double kLeastCandidate = 0.1 / 3;  // of the largest force

std::vector<ChosenForce> candidates_of(const PreparedObject& object, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(0, 1);
  const double most = object.plan.options.max_force;
  std::vector<ChosenForce> candidates;
  for (std::size_t c = 0; c < object.plan.contacts.size(); ++c) {
    const probing::FrictionCone cone =
        object.specimen->friction_cone(object.plan.contacts[c].position);
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), cone.axis);
    for (int i = 0; i < kCandidatesPerContact; ++i) {
      const double size = most * (kLeastCandidate + (1 - kLeastCandidate) * share(random));
      const double ratio = kCandidateInside * cone.coefficient * std::sqrt(share(random));
      const double angle = 2 * std::numbers::pi * share(random);
      const Vector3d along(ratio * std::cos(angle), ratio * std::sin(angle), 1);
      // Each force is pressed by itself, so that it has a level of its own.
      candidates.push_back({c, size * (turn * along).normalized(), i});
    }
  }
  return candidates;
}

struct PlainData {
  Eigen::Matrix3Xd places, displacements, forces;
  Eigen::MatrixXd place_distances, displacement_distances;  // squared
};

Eigen::MatrixXd squared_distances_between(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  Eigen::MatrixXd result = -2 * a.transpose() * b;
  result.colwise() += a.colwise().squaredNorm().transpose();
  result.rowwise() += b.colwise().squaredNorm();
  return result.cwiseMax(0);
}

// \param presses also the positions under the normal part of each force alone
PlainData plain_data(const probing::Acquisition& acquisition, bool presses) {
  std::vector<Vector3d> places, displacements, forces;
  for (const probing::Contact& contact : acquisition.contacts) {
    places.push_back(contact.position);
    displacements.emplace_back(Vector3d::Zero());
    forces.emplace_back(Vector3d::Zero());
    for (const probing::Sample& sample : acquisition.samples) {
      if (sample.contact != contact.id) continue;
      if (presses) {
        places.push_back(contact.position);
        displacements.push_back(sample.a - contact.position);
        forces.push_back(sample.force.dot(contact.normal) * contact.normal);
      }
      if (sample.slipped) continue;
      places.push_back(contact.position);
      displacements.push_back(sample.b - contact.position);
      forces.push_back(sample.force);
    }
  }
  const auto matrix = [](const std::vector<Vector3d>& columns) {
    Eigen::Matrix3Xd result(3, static_cast<Eigen::Index>(columns.size()));
    for (std::size_t i = 0; i < columns.size(); ++i)
      result.col(static_cast<Eigen::Index>(i)) = columns[i];
    return result;
  };
  PlainData data{matrix(places), matrix(displacements), matrix(forces), {}, {}};
  data.place_distances = squared_distances_between(data.places, data.places);
  data.displacement_distances = squared_distances_between(data.displacements, data.displacements);
  return data;
}

struct PlainParameters {
  double place = 20, displacement = 1, noise = 1e-3;  // [mm], [mm], share of the signal's power
};

Eigen::MatrixXd plain_kernel(const Eigen::MatrixXd& place_distances,
                             const Eigen::MatrixXd& displacement_distances,
                             const PlainParameters& with) {
  return (-place_distances.array() / (2 * with.place * with.place) -
          displacement_distances.array() / (2 * with.displacement * with.displacement))
      .exp();
}

// Logarithm of the marginal likelihood of all components with the best power of the signal, which
// they share, up to a constant.
double plain_likelihood(const PlainData& data, const PlainParameters& with) {
  Eigen::MatrixXd gram = plain_kernel(data.place_distances, data.displacement_distances, with);
  gram.diagonal().array() += with.noise;
  const Eigen::LLT<Eigen::MatrixXd> factor(gram);
  if (factor.info() != Eigen::Success) return -std::numeric_limits<double>::infinity();
  const Eigen::MatrixXd whitened = factor.matrixL().solve(data.forces.transpose());
  const auto n = static_cast<double>(data.forces.size());
  const double determinant = 2 * factor.matrixLLT().diagonal().array().log().sum();
  return -n / 2 * std::log(whitened.squaredNorm() / n) - 3 * determinant / 2;
}

PlainParameters most_likely(const PlainData& data) {
  constexpr int kSweeps = 2;
  constexpr double kStep = 1.4;  // ratio of neighbouring candidates
  constexpr int kSteps = 5;      // to each side
  PlainParameters best{.displacement = std::sqrt(data.displacements.squaredNorm() /
                                                 static_cast<double>(data.displacements.cols()))};
  double value = plain_likelihood(data, best);
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (double PlainParameters::*parameter :
         {&PlainParameters::place, &PlainParameters::displacement, &PlainParameters::noise}) {
      const double step = parameter == &PlainParameters::noise ? kStep * kStep : kStep;
      const PlainParameters from = best;
      for (int k = -kSteps; k <= kSteps; ++k) {
        PlainParameters tried = from;
        tried.*parameter *= std::pow(step, k);
        const double found = plain_likelihood(data, tried);
        if (found <= value) continue;
        value = found;
        best = tried;
      }
    }
  }
  return best;
}

}  // namespace

std::vector<ChosenForce> choose_by_variance(const PreparedObject& object, int samples,
                                            unsigned seed) {
  const std::vector<ChosenForce> candidates = candidates_of(object, seed);
  const auto count = static_cast<Eigen::Index>(candidates.size());
  const auto wanted = std::min<Eigen::Index>(samples, count);
  Eigen::Matrix3Xd places(3, count), forces(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const ChosenForce& one = candidates[static_cast<std::size_t>(i)];
    places.col(i) = object.plan.contacts[one.contact].position / kPlaceLength;
    forces.col(i) = one.force / (kForceLength * object.plan.options.max_force);
  }
  // The greedy choice is a Cholesky factorisation with pivots.
  Eigen::VectorXd variance = Eigen::VectorXd::Ones(count);
  Eigen::MatrixXd factor(count, wanted);
  std::vector<ChosenForce> chosen;
  for (Eigen::Index k = 0; k < wanted; ++k) {
    Eigen::Index pivot = 0;
    const double most = variance.maxCoeff(&pivot);
    Eigen::VectorXd column = (-((places.colwise() - places.col(pivot)).colwise().squaredNorm() +
                                (forces.colwise() - forces.col(pivot)).colwise().squaredNorm()) /
                              2)
                                 .array()
                                 .exp()
                                 .matrix()
                                 .transpose();
    column -= factor.leftCols(k) * factor.row(pivot).head(k).transpose();
    factor.col(k) = column / std::sqrt(most);
    variance -= factor.col(k).cwiseAbs2();
    variance[pivot] = -1;  // taken
    chosen.push_back(candidates[static_cast<std::size_t>(pivot)]);
  }
  return chosen;
}

Eigen::Matrix3Xd predict_plainly(const probing::Acquisition& acquisition,
                                 const std::vector<probing::KnownForce>& queries) {
  const PlainParameters with = most_likely(plain_data(acquisition, false));
  const PlainData data = plain_data(acquisition, true);
  Eigen::MatrixXd gram = plain_kernel(data.place_distances, data.displacement_distances, with);
  gram.diagonal().array() += with.noise;
  const Eigen::MatrixXd weights = gram.llt().solve(data.forces.transpose());
  Eigen::Matrix3Xd places(3, static_cast<Eigen::Index>(queries.size())), displacements = places;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    places.col(static_cast<Eigen::Index>(i)) = queries[i].contact;
    displacements.col(static_cast<Eigen::Index>(i)) = queries[i].displacement;
  }
  const Eigen::MatrixXd cross =
      plain_kernel(squared_distances_between(places, data.places),
                   squared_distances_between(displacements, data.displacements), with);
  return (cross * weights).transpose();
}

}  // namespace palpate::bench
