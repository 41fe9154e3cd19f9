// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/pressing_field.h"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace palpate::haptics {
namespace {

// Centres and roundings of the ridges, relative to the reach of the curve.
constexpr std::array kRidgeCentres = {0.0, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0};
constexpr std::array kRidgeRoundings = {0.3, 0.6, 1.2, 2.4};
constexpr Eigen::Index kRidges = kRidgeCentres.size() * kRidgeRoundings.size();
// Points within the reach and beyond it, and how much those beyond count.
constexpr int kPointsWithin = 16, kPointsBeyond = 4;
constexpr double kWeightBeyond = 0.1;
// Depth of the secant stiffness, relative to the reach; larger forces matter more.
constexpr double kSecantDepth = 0.7;
// [reach] Rounding of the springs across: linear within what tools reach.
constexpr double kSpringRounding = 4;
// A weight counts as zero below this share of the largest force.
constexpr double kLeastRidgeWeight = 1e-6;
constexpr int kMaxActiveSetRounds = 100;

double ridge_force(double zeta, double centre, double rounding) {
  const double from = zeta - centre;
  return from / std::hypot(from, rounding) + centre / std::hypot(centre, rounding);
}

double zeta_of(int point) { return static_cast<double>(point + 1) / kPointsWithin; }

double weight_of(int point) { return point < kPointsWithin ? 1 : kWeightBeyond; }

Eigen::MatrixXd ridge_table() {
  Eigen::MatrixXd table(kPointsWithin + kPointsBeyond, kRidges);
  for (int p = 0; p < table.rows(); ++p) {
    Eigen::Index column = 0;
    for (const double centre : kRidgeCentres)
      for (const double rounding : kRidgeRoundings)
        table(p, column++) = weight_of(p) * ridge_force(zeta_of(p), centre, rounding);
  }
  return table;
}

// Minimises |table x - target| with x >= 0 (Lawson and Hanson 1974, ch. 23).
Eigen::VectorXd nonnegative_weights(const Eigen::MatrixXd& table, const Eigen::VectorXd& target) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(table.cols());
  std::vector<Eigen::Index> active;
  const double tolerance = kLeastRidgeWeight * table.norm() * target.norm();
  for (int round = 0; round < kMaxActiveSetRounds; ++round) {
    Eigen::VectorXd gradient = table.transpose() * (target - table * x);
    for (const Eigen::Index i : active) gradient(i) = 0;
    Eigen::Index steepest = 0;
    if (!(gradient.maxCoeff(&steepest) > tolerance)) break;
    active.push_back(steepest);
    while (!active.empty()) {
      const Eigen::MatrixXd columns = table(Eigen::all, active);
      const Eigen::VectorXd solution = columns.colPivHouseholderQr().solve(target);
      double step = 1;
      for (std::size_t a = 0; a < active.size(); ++a) {
        const auto s = static_cast<Eigen::Index>(a);
        if (solution(s) > 0) continue;
        const double fall = x(active[a]) - solution(s);
        step = fall > 0 ? std::min(step, x(active[a]) / fall) : 0;
      }
      for (std::size_t a = 0; a < active.size(); ++a)
        x(active[a]) += step * (solution(static_cast<Eigen::Index>(a)) - x(active[a]));
      if (step >= 1) break;
      const double least = kLeastRidgeWeight * x.maxCoeff();
      std::erase_if(active, [&](Eigen::Index i) {
        if (x(i) > least) return false;
        x(i) = 0;
        return true;
      });
    }
  }
  return x;
}

// The same with at most `most` weights that are not zero: those that the others replace best go,
// one after the other.
Eigen::VectorXd few_weights(const Eigen::MatrixXd& table, const Eigen::VectorXd& target,
                            std::size_t most) {
  Eigen::VectorXd weights = nonnegative_weights(table, target);
  const auto used = [&] {
    std::vector<Eigen::Index> result;
    for (Eigen::Index i = 0; i < weights.size(); ++i)
      if (weights(i) > 0) result.push_back(i);
    return result;
  };
  for (std::vector<Eigen::Index> kept = used(); kept.size() > most; kept = used()) {
    double least = std::numeric_limits<double>::infinity();
    Eigen::VectorXd best = Eigen::VectorXd::Zero(weights.size());
    for (std::size_t left = 0; left < kept.size(); ++left) {
      std::vector<Eigen::Index> others = kept;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(left));
      const Eigen::MatrixXd columns = table(Eigen::all, others);
      const Eigen::VectorXd found = nonnegative_weights(columns, target);
      const double error = (columns * found - target).squaredNorm();
      if (!(error < least)) continue;
      least = error;
      best.setZero();
      for (std::size_t k = 0; k < others.size(); ++k)
        best(others[k]) = found(static_cast<Eigen::Index>(k));
    }
    weights = best;
  }
  return weights;
}

}  // namespace

ForceField pressing_field(const PressingCurve& curve, double lateral_ratio, int max_bases) {
  static const Eigen::MatrixXd table = ridge_table();
  ForceField field;
  if (!(curve.reach > 0)) return field;
  Eigen::VectorXd target(table.rows());
  double force = 0, step = 0;
  for (int p = 0; p < target.size(); ++p) {
    if (p < kPointsWithin) {
      step = std::max(force_at(curve, zeta_of(p) * curve.reach) - force, 0.0);
    }
    force += step;
    target(p) = weight_of(p) * force;
  }
  if (!(force > 0)) return field;
  const Eigen::VectorXd weights =
      few_weights(table, target, static_cast<std::size_t>(max_bases - kFewestPressingBases + 1));
  Eigen::Index column = 0;
  for (const double centre : kRidgeCentres) {
    for (const double rounding : kRidgeRoundings) {
      const double weight = weights(column++);
      if (!(weight > kLeastRidgeWeight * force)) continue;
      field.bases.push_back({.weight = weight,
                             .epsilon = rounding * curve.reach,
                             .center = {0, 0, centre * curve.reach},
                             .ridge = Eigen::Vector3d::UnitZ()});
    }
  }
  const double depth = kSecantDepth * curve.reach;
  const double stiffness =
      lateral_ratio * palpate::haptics::force(field, {0, 0, depth}).z() / depth;
  const double rounding = kSpringRounding * curve.reach;
  if (!(stiffness > 0)) return field;
  for (const Eigen::Vector3d& axis : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0)}) {
    field.bases.push_back({.weight = stiffness * rounding, .epsilon = rounding, .ridge = axis});
  }
  return field;
}

}  // namespace palpate::haptics
