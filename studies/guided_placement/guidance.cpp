// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "guidance.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

#include "palpate/probing/stiffness_process.h"

namespace palpate::bench {
namespace {

constexpr double kLawLength = 10;         // [mm] unit of distances in the law of the motion
constexpr double kStiffnessNoise = 0.02;  // of the logarithm of a stiffness
constexpr double kLackNoise = 0.05;       // of that of a seen motion
constexpr std::size_t kFewestSeen = 6, kFewestGuiding = 6;  // contacts begun
constexpr double kTelling = 2;  // standard errors of a slope that counts
constexpr double kUnseen = std::numeric_limits<double>::quiet_NaN();

// Logarithms of stiffness, kriged from some candidates to all, where `values` has the logarithms at
// those; `noise` of each.
Eigen::VectorXd kriged(const ProbedObject& object, const std::vector<std::size_t>& from,
                       const Eigen::VectorXd& values, double noise) {
  std::vector<probing::ContactStiffness> known;
  for (const std::size_t i : from) {
    const double size = std::exp(values(static_cast<Eigen::Index>(i)));
    known.push_back({object.plan.contacts[i].position, size, noise * size});
  }
  const probing::StiffnessProcess process(known);
  Eigen::VectorXd result(values.size());
  for (Eigen::Index j = 0; j < result.size(); ++j)
    result(j) = std::log(
        process.predict(object.plan.contacts[static_cast<std::size_t>(j)].position).stiffness);
  return result;
}

// How much less each candidate moves than the distance to the forces lets expect, in the shapes of
// the contacts begun: the mean over these of the logarithm, weighted with the inverse squared
// distance. The law of the distance is fitted to the pairs of contacts begun; by reciprocity, the
// motion of j under a force at i is that of i under a force at j, so that the compliance of both
// counts alike. NaN where no motion is seen.
Eigen::VectorXd seen_lack(const ProbedObject& object, const std::vector<std::size_t>& begun,
                          const Eigen::MatrixXd& motions) {
  const auto motion = [&](std::size_t i, std::size_t j) {
    return std::log(motions(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)));
  };
  const auto law = [&](std::size_t i, std::size_t j) {
    const double r = distance(object, i, j) / kLawLength;
    const double across =
        std::abs(object.plan.contacts[i].position.x() - object.plan.contacts[j].position.x()) /
        kLawLength;
    return Eigen::Vector4d(1, r, r * r, across);
  };
  const auto half = [&](std::size_t i) {
    return object.stiffness(static_cast<Eigen::Index>(i)) / 2;
  };
  // Little beside the ones of a pair of contacts; keeps the law defined for few pairs.
  constexpr double kRidge = 1e-6;
  Eigen::Matrix4d normal = kRidge * Eigen::Matrix4d::Identity();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (const std::size_t i : begun) {
    for (const std::size_t j : begun) {
      if (i == j || std::isnan(motion(i, j))) continue;
      normal += law(i, j) * law(i, j).transpose();
      right += (motion(i, j) + half(i) + half(j)) * law(i, j);
    }
  }
  const Eigen::Vector4d fitted = normal.ldlt().solve(right);
  Eigen::VectorXd result = Eigen::VectorXd::Constant(motions.cols(), kUnseen);
  for (std::size_t j = 0; j < object.plan.contacts.size(); ++j) {
    double sum = 0, weights = 0;
    for (const std::size_t i : begun) {
      if (i == j || std::isnan(motion(i, j))) continue;
      const double weight = std::pow(distance(object, i, j), -2);
      sum -= weight * (motion(i, j) + half(i) - fitted.dot(law(i, j)));
      weights += weight;
    }
    if (weights > 0) result(static_cast<Eigen::Index>(j)) = sum / weights;
  }
  return result;
}

double nearest_begun(const ProbedObject& object, const std::vector<std::size_t>& begun,
                     std::size_t j) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const std::size_t i : begun) nearest = std::min(nearest, distance(object, i, j));
  return nearest;
}

// The gain of each candidate: its distance from the contacts begun, which gives the order of plans,
// and more where the surface moves differently from what kriging lets expect.
Eigen::VectorXd gains_of(const ProbedObject& object, Guide guide,
                         const std::vector<std::size_t>& begun) {
  const auto count = static_cast<Eigen::Index>(object.plan.contacts.size());
  Eigen::VectorXd misfit = Eigen::VectorXd::Zero(count);
  if (guide != Guide::none && begun.size() >= kFewestGuiding) {
    const Eigen::VectorXd expected =
        guide == Guide::truth
            ? object.stiffness
            : seen_stiffness(object, begun, guide == Guide::shapes ? object.seen : object.exactly);
    misfit = (expected - felt_stiffness(object, begun)).cwiseAbs();
    if (misfit.mean() > 0) misfit /= misfit.mean();
  }
  Eigen::VectorXd gains(count);
  for (Eigen::Index j = 0; j < count; ++j)
    gains(j) = nearest_begun(object, begun, static_cast<std::size_t>(j)) * (1 + misfit(j));
  return gains;
}

}  // namespace

Eigen::VectorXd felt_stiffness(const ProbedObject& object, const std::vector<std::size_t>& begun) {
  return kriged(object, begun, object.stiffness, kStiffnessNoise);
}

Eigen::VectorXd seen_stiffness(const ProbedObject& object, const std::vector<std::size_t>& begun,
                               const Eigen::MatrixXd& motions) {
  const Eigen::VectorXd plain = felt_stiffness(object, begun);
  const Eigen::VectorXd lack = seen_lack(object, begun, motions);
  std::vector<std::size_t> seen;
  for (const std::size_t i : begun) {
    if (std::isfinite(lack(static_cast<Eigen::Index>(i)))) seen.push_back(i);
  }
  if (seen.size() < kFewestSeen) return plain;
  double xx = 0, xy = 0, yy = 0;
  for (const std::size_t out : seen) {
    std::vector<std::size_t> others;
    for (const std::size_t i : seen) {
      if (i != out) others.push_back(i);
    }
    const auto at = static_cast<Eigen::Index>(out);
    const double x = lack(at) - kriged(object, others, lack, kLackNoise)(at);
    const double y = object.stiffness(at) - felt_stiffness(object, others)(at);
    xx += x * x;
    xy += x * y;
    yy += y * y;
  }
  const double slope = xy / xx;
  const double error = std::sqrt((yy / xx - slope * slope) / static_cast<double>(seen.size() - 1));
  if (!(slope > kTelling * error)) return plain;
  const Eigen::VectorXd expected = kriged(object, seen, lack, kLackNoise);
  return plain +
         slope * (lack - expected).unaryExpr([](double x) { return std::isnan(x) ? 0 : x; });
}

std::vector<std::size_t> order_of(const ProbedObject& object, Guide guide, std::size_t first,
                                  std::size_t most) {
  std::vector<std::size_t> begun{first};
  while (begun.size() < most) {
    Eigen::Index best = 0;
    gains_of(object, guide, begun).maxCoeff(&best);
    begun.push_back(static_cast<std::size_t>(best));
  }
  return begun;
}

}  // namespace palpate::bench
