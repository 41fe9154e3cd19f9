// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "pressing_peers.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

namespace palpate::bench {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Places around a query among which its Delaunay triangle is sought.
constexpr std::size_t kAround = 14;
constexpr std::size_t kMostRecords = 400, kMostPlaces = 150;

std::vector<std::size_t> nearest(std::span<const PressedPlace> places, const Vector2d& at,
                                 std::size_t most) {
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < places.size(); ++i)
    order.emplace_back((places[i].at - at).squaredNorm(), i);
  most = std::min(most, order.size());
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(most), order.end());
  std::vector<std::size_t> result;
  for (std::size_t k = 0; k < most; ++k) result.push_back(order[k].second);
  return result;
}

double force_at_depth(const PressedPlace& place, double depth) {
  std::vector<std::pair<double, double>> sorted;
  for (std::size_t i = 0; i < place.depths.size(); ++i)
    sorted.emplace_back(place.depths[i], place.forces[i]);
  std::sort(sorted.begin(), sorted.end());
  if (sorted.size() == 1) return sorted[0].second;
  std::size_t i = 1;
  while (i + 1 < sorted.size() && sorted[i].first < depth) ++i;
  // Loading and unloading may have the same depths; take the mean of both where they do.
  const auto& [d0, f0] = sorted[i - 1];
  const auto& [d1, f1] = sorted[i];
  const double share = d1 > d0 ? std::clamp((depth - d0) / (d1 - d0), -1.0, 2.0) : 0.5;
  return f0 + share * (f1 - f0);
}

// Records at about one depth (within a twentieth of the largest) averaged, as one would do with
// repeated or returning records.
PressedPlace averaged(const PressedPlace& place) {
  std::vector<std::pair<double, double>> sorted;
  for (std::size_t i = 0; i < place.depths.size(); ++i)
    sorted.emplace_back(place.depths[i], place.forces[i]);
  std::sort(sorted.begin(), sorted.end());
  PressedPlace result{place.at, {}, {}};
  const double same = 0.02 * sorted.back().first;
  for (std::size_t i = 0; i < sorted.size();) {
    std::size_t end = i;
    double depth = 0, force = 0;
    while (end < sorted.size() && sorted[end].first - sorted[i].first <= same) {
      depth += sorted[end].first;
      force += sorted[end++].second;
    }
    const double count = static_cast<double>(end - i);
    result.depths.push_back(depth / count);
    result.forces.push_back(force / count);
    i = end;
  }
  return result;
}

bool in_circle(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& p) {
  Eigen::Matrix3d m;
  m << (a - p).transpose(), (a - p).squaredNorm(), (b - p).transpose(), (b - p).squaredNorm(),
      (c - p).transpose(), (c - p).squaredNorm();
  const double turn = (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
  return m.determinant() * turn > 1e-9;
}

double covariance(const ProcessSettings& settings, const Vector3d& a, const Vector3d& b) {
  const double r = (a - b).cwiseQuotient(settings.lengths).norm();
  const double square = settings.amplitude * settings.amplitude;
  if (!settings.matern) return square * std::exp(-r * r / 2);
  const double s = std::sqrt(5.0) * r;
  return square * (1 + s + s * s / 3) * std::exp(-s);
}

struct Records {
  std::vector<Vector3d> at;
  std::vector<double> forces;
};

Records records_of(std::span<const PressedPlace> places, std::span<const std::size_t> chosen) {
  Records records;
  for (const std::size_t i : chosen) {
    for (std::size_t j = 0; j < places[i].depths.size(); ++j) {
      records.at.emplace_back(places[i].at.x(), places[i].at.y(), places[i].depths[j]);
      records.forces.push_back(places[i].forces[j]);
    }
  }
  return records;
}

Eigen::MatrixXd covariances(const ProcessSettings& settings, const Records& records) {
  const auto count = static_cast<Eigen::Index>(records.at.size());
  Eigen::MatrixXd result(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j)
      result(i, j) = result(j, i) = covariance(settings, records.at[static_cast<std::size_t>(i)],
                                               records.at[static_cast<std::size_t>(j)]);
    result(i, i) += settings.noise * settings.noise;
  }
  return result;
}

Eigen::VectorXd centred(const ProcessSettings& settings, const Records& records) {
  return Eigen::Map<const Eigen::VectorXd>(records.forces.data(),
                                           static_cast<Eigen::Index>(records.forces.size()))
             .array() -
         settings.mean;
}

double loss_of(const ProcessSettings& settings, const Records& records) {
  const Eigen::LLT<Eigen::MatrixXd> factor(covariances(settings, records));
  if (factor.info() != Eigen::Success) return 1e300;
  return factor.matrixL().solve(centred(settings, records)).squaredNorm() +
         2 * factor.matrixLLT().diagonal().array().log().sum();
}

}  // namespace

double barycentric_force(std::span<const PressedPlace> places, const Vector2d& at, double depth) {
  const std::vector<std::size_t> around = nearest(places, at, kAround);
  const auto force = [&](std::size_t k) {
    return force_at_depth(averaged(places[around[k]]), depth);
  };
  for (std::size_t i = 0; i < around.size(); ++i) {
    for (std::size_t j = i + 1; j < around.size(); ++j) {
      for (std::size_t k = j + 1; k < around.size(); ++k) {
        const Vector2d &a = places[around[i]].at, &b = places[around[j]].at,
                       &c = places[around[k]].at;
        Eigen::Matrix2d sides;
        sides << b - a, c - a;
        if (std::abs(sides.determinant()) < 1e-9) continue;
        const Vector2d weights = sides.inverse() * (at - a);
        if (weights.minCoeff() < -1e-9 || weights.sum() > 1 + 1e-9) continue;
        const bool empty = std::none_of(around.begin(), around.end(), [&](std::size_t p) {
          return in_circle(a, b, c, places[p].at);
        });
        if (empty)
          return (1 - weights.sum()) * force(i) + weights.x() * force(j) + weights.y() * force(k);
      }
    }
  }
  return force(0);
}

ProcessSettings learn_process(std::span<const PressedPlace> places) {
  // Contiguous records show the noise and short lengths, places all over the object long ones.
  std::vector<std::size_t> chosen(places.size());
  for (std::size_t i = 0; i < chosen.size(); ++i) chosen[i] = i;
  std::mt19937 random(1);
  std::shuffle(chosen.begin(), chosen.end(), random);
  const std::size_t each = places[0].depths.size();
  const std::size_t most = std::max<std::size_t>(kMostRecords / each, 1);
  if (chosen.size() > most) {
    // Half of them around one place, the others anywhere.
    std::vector<std::size_t> some = nearest(places, places[chosen[0]].at, most / 2);
    for (const std::size_t i : chosen) {
      if (some.size() >= most) break;
      if (std::find(some.begin(), some.end(), i) == some.end()) some.push_back(i);
    }
    chosen = some;
  }
  const Records records = records_of(places, chosen);
  ProcessSettings first;
  double sum = 0, squares = 0, deepest = 0;
  for (std::size_t i = 0; i < records.forces.size(); ++i) {
    sum += records.forces[i];
    squares += records.forces[i] * records.forces[i];
    deepest = std::max(deepest, records.at[i].z());
  }
  const double count = static_cast<double>(records.forces.size());
  first.mean = sum / count;
  first.amplitude = std::sqrt(squares / count);
  first.noise = 0.03 * first.amplitude;
  first.lengths = {15, 15, deepest};
  ProcessSettings best = first;
  double least = 1e301;
  for (const bool matern : {false, true}) {
    ProcessSettings at = first;
    at.matern = matern;
    double loss = loss_of(at, records);
    for (double step = 1; step >= 0.2; step /= 2) {
      bool better = true;
      for (int round = 0; better && round < 6; ++round) {
        better = false;
        for (int axis = 0; axis < 5; ++axis) {
          for (const double sign : {1.0, -1.0}) {
            ProcessSettings next = at;
            double& value = axis < 3 ? next.lengths(axis) : axis == 3 ? next.amplitude : next.noise;
            value *= std::exp2(sign * step);
            const double found = loss_of(next, records);
            if (!(found < loss)) continue;
            loss = found;
            at = next;
            better = true;
            break;
          }
        }
      }
    }
    if (loss < least) {
      least = loss;
      best = at;
    }
  }
  return best;
}

std::vector<double> process_forces(const ProcessSettings& settings,
                                   std::span<const PressedPlace> places,
                                   const PressedPlace& wanted) {
  // The data of many places are beyond one factorisation: those around suffice.
  const std::size_t most =
      std::min(kMostPlaces, std::max<std::size_t>(kMostRecords / wanted.depths.size(), 12));
  const Records records = records_of(places, nearest(places, wanted.at, most));
  const Eigen::LLT<Eigen::MatrixXd> factor(covariances(settings, records));
  const Eigen::VectorXd weights = factor.solve(centred(settings, records));
  std::vector<double> result;
  for (const double depth : wanted.depths) {
    const Vector3d at(wanted.at.x(), wanted.at.y(), depth);
    double force = settings.mean;
    for (std::size_t i = 0; i < records.at.size(); ++i)
      force += covariance(settings, at, records.at[i]) * weights(static_cast<Eigen::Index>(i));
    result.push_back(force);
  }
  return result;
}

}  // namespace palpate::bench
