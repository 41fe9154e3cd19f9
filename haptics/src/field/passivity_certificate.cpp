// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/passivity_certificate.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <string>
#include <vector>

#include "field/energy_bound.h"
#include "palpate/core/require.h"

namespace palpate::haptics {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// More than the relative rounding error of a length.
constexpr double kLengthSlack = 1e-12;
// Smallest cell relative to the volume. Down to this size the centres have no rounding error.
constexpr double kSmallestCell = 0x1p-28;
// Descent from a place where the energy is negative.
constexpr int kDescentSteps = 40;
constexpr double kSmallestStep = 1e-3;  // of the displacement
// Bounds of changed numbers are first-order, with a margin that covers changes up to this.
constexpr double kMaxNumberTolerance = 1e-3;

void check(const ForceField& field, const ReachableVolume& volume,
           const CertificateOptions& options) {
  check_force_field(field, "certify_passivity()");
  require("ReachableVolume::radius", volume.radius, at_least(0).finite(), "mm");
  require("CertificateOptions::number_tolerance", options.number_tolerance,
          at_least(0).at_most(kMaxNumberTolerance));
  require("CertificateOptions::energy_tolerance", options.energy_tolerance, at_least(0), "N mm");
  require("CertificateOptions::max_cells", options.max_cells, at_least(1));
}

// Rounds up to so few digits that the centres of a cube's cells have no rounding error.
double round_up(double length) {
  int exponent = 0;
  const double digits = std::frexp(length, &exponent);
  constexpr double kDigits = 0x1p20;
  return std::ldexp(std::ceil(digits * kDigits) / kDigits, exponent);
}

double secant_stiffness(const ForceField& field, const Eigen::Vector3d& place) {
  return 2 * potential(field, place) / place.squaredNorm();
}

// Minimises the secant stiffness within the volume, to find where the energy is most negative.
Eigen::Vector3d descend(const ForceField& field, double radius, Eigen::Vector3d place) {
  double lowest = secant_stiffness(field, place), step = 0.25;
  for (int i = 0; i < kDescentSteps && step > kSmallestStep; ++i) {
    const Eigen::Vector3d uphill = force(field, place) - lowest * place;
    if (!(uphill.norm() > 0)) break;
    Eigen::Vector3d next = place - step * place.norm() * uphill.normalized();
    if (next.norm() > radius) next *= radius * (1 - kLengthSlack) / next.norm();
    const double found = secant_stiffness(field, next);
    if (found < lowest) {
      place = next;
      lowest = found;
      step *= 2;
    } else {
      step /= 2;
    }
  }
  return place;
}

struct Candidate {
  double lowest;  // bound of q in the cell
  int number;     // resolves ties by age
  Cell cell;

  // The top of the queue is the cell with the lowest bound.
  friend bool operator<(const Candidate& left, const Candidate& right) {
    return left.lowest != right.lowest ? left.lowest > right.lowest : left.number > right.number;
  }
};

class Search {
 public:
  Search(const ForceField& field, double radius, const CertificateOptions& options)
      : field_(field),
        options_(options),
        radius_(radius),
        bound_(field, radius, options.number_tolerance),
        safe_radius_(bound_.safe_radius()) {}

  PassivityCertificate run() {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(
        stiffness(field_, Eigen::Vector3d::Zero()), Eigen::EigenvaluesOnly);
    result_.weakest_stiffness = eigen.eigenvalues()[0];
    queue_.push({0, 0, {Eigen::Vector3d::Zero(), round_up(radius_)}});
    while (!queue_.empty()) {
      const Cell cell = queue_.top().cell;
      queue_.pop();
      for (int corner = 0; corner < 8; ++corner) {
        if (!settle(part(cell, corner))) return result_;
      }
    }
    result_.passivity = Passivity::certified;
    return result_;
  }

 private:
  static Cell part(const Cell& cell, int corner) {
    const double half = cell.half_width / 2;
    const Eigen::Vector3d offset((corner & 1) != 0 ? half : -half, (corner & 2) != 0 ? half : -half,
                                 (corner & 4) != 0 ? half : -half);
    return {cell.center + offset, half};
  }

  [[nodiscard]] bool is_settled(const Cell& cell) const {
    const Eigen::Array3d distance = cell.center.array().abs();
    return (distance - cell.half_width).max(0).matrix().norm() > radius_ * (1 + kLengthSlack) ||
           (distance + cell.half_width).matrix().norm() < safe_radius_ * (1 - kLengthSlack);
  }

  // Proves a cell or queues it for subdivision; false if the search is over.
  bool settle(const Cell& cell) {
    if (is_settled(cell)) return true;
    if (result_.cells == options_.max_cells) return false;
    ++result_.cells;
    const EnergyBound::InCell bound = bound_.in_cell(cell);
    if (cell.center.norm() <= radius_ && !inspect(cell.center, bound.at_center)) return false;
    if (bound.lowest >= -options_.energy_tolerance) return true;
    // An overflowed bound carries no information and must not enter the queue.
    const double lowest = std::isnan(bound.lowest) ? -kInfinity : bound.lowest;
    queue_.push({lowest, result_.cells, cell});
    return cell.half_width > kSmallestCell * radius_;
  }

  // False if the energy at a place disproves the claim.
  bool inspect(const Eigen::Vector3d& place, const RoundedNumber& energy) {
    const double secant = secant_stiffness(field_, place);
    if (secant < result_.weakest_stiffness) {
      result_.weakest = place;
      result_.weakest_stiffness = secant;
    }
    if (!(energy.upper() < -options_.energy_tolerance)) return true;
    const Eigen::Vector3d deepest = descend(field_, radius_, place);
    const Eigen::Vector3d& worst = is_violation(deepest) ? deepest : place;
    result_.weakest = worst;
    result_.weakest_stiffness = secant_stiffness(field_, worst);
    if (is_violation(worst)) result_.passivity = Passivity::violated;
    return false;
  }

  [[nodiscard]] bool is_violation(const Eigen::Vector3d& place) const {
    return bound_.energy(place).upper() < -options_.energy_tolerance;
  }

  const ForceField& field_;
  const CertificateOptions& options_;
  double radius_;
  EnergyBound bound_;
  double safe_radius_;
  PassivityCertificate result_;
  std::priority_queue<Candidate> queue_;
};

}  // namespace

ReachableVolume reachable_volume(const Eigen::Ref<const Eigen::Matrix3Xd>& displacements) {
  if (displacements.cols() == 0) return {};
  return {kReachFactor * displacements.colwise().stableNorm().maxCoeff()};
}

PassivityCertificate certify_passivity(const ForceField& field, const ReachableVolume& volume,
                                       const CertificateOptions& options) {
  check(field, volume, options);
  PassivityCertificate result;
  const auto negative = [](const Multiquadric& base) { return base.weight < 0; };
  if (std::none_of(field.bases.begin(), field.bases.end(), negative)) {
    result.passivity = Passivity::convex;
  } else if (volume.radius == 0) {
    result.passivity = Passivity::certified;
  } else {
    result = Search(field, volume.radius, options).run();
  }
  result.volume = volume;
  return result;
}

bool is_passive(const PassivityCertificate& certificate) {
  return certificate.passivity == Passivity::convex ||
         certificate.passivity == Passivity::certified;
}

const char* to_string(Passivity passivity) {
  switch (passivity) {
    case Passivity::convex:
      return "convex";
    case Passivity::certified:
      return "certified";
    case Passivity::violated:
      return "violated";
    case Passivity::undecided:
      return "undecided";
  }
  return "unknown";
}

}  // namespace palpate::haptics
