// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/local_fit.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "fit/field_solver.h"
#include "fit/whitened_problem.h"

namespace palpate::haptics {
namespace {

// Start positions of a new base, as multiples of the displacements.
constexpr std::array<double, 4> kStartMultiples = {1, -1, 2, -2};
// For each number of bases, the best starts that are kStartSpacing apart (in units of the data's
// extent) are tried: kMinStarts of them, and up to kMaxStarts until the criterion improves.
constexpr int kMinStarts = 2;
constexpr int kMaxStarts = 4;
constexpr double kStartSpacing = 0.5;
// Penalty of weights in the choice of starts, relative to the data's force.
constexpr double kRidge = 1e-3;
// Least stiffness at zero, and least secant stiffness 2 p / |x|^2 at the places of repairs, in
// units of force / extent, where the data have about 1. They are large enough for a safe ball
// around zero that saves cells of the certificate, and to avoid repeated repairs at nearby places.
constexpr double kLeastStiffness = 0.02;
constexpr double kLeastSecant = 0.02;
constexpr int kMaxRepairs = 30;

// Extends a field by one base, whose centre is varied. Ranks the centres by linear least squares
// (thesis 5.3.1.2: "a starting point ...").
class Starts {
 public:
  Starts(const FieldObjective& objective, const ForceField& field, double epsilon)
      : objective_(objective), field_(field), epsilon_(epsilon) {
    const auto old = static_cast<Eigen::Index>(field.bases.size());
    matrix_.resize(objective.forces.size() + old + 1, old + 1);
    for (Eigen::Index k = 0; k < old; ++k) {
      matrix_.col(k) = column(field.bases[static_cast<std::size_t>(k)], k);
    }
    target_ = Eigen::VectorXd::Zero(matrix_.rows());
    target_.head(objective.forces.size()) = objective.forces.reshaped();
    rank_places();
  }

  /// The n-th best start at some distance from the better ones; nullopt if there are no more.
  [[nodiscard]] std::optional<ForceField> select(int n) {
    std::vector<Eigen::Vector3d> chosen;
    for (const Place& place : places_) {
      const auto near = [&](const Eigen::Vector3d& other) {
        return (other - place.center).norm() < kStartSpacing;
      };
      if (std::any_of(chosen.begin(), chosen.end(), near)) continue;
      chosen.push_back(place.center);
      if (static_cast<int>(chosen.size()) > n) return with_base_at(place.center);
    }
    return std::nullopt;
  }

 private:
  struct Place {
    double gain;  // by which the squared error falls
    Eigen::Vector3d center;
  };

  // Forces of one base with weight 1 at all displacements. The additional rows penalise the
  // weights, so that bases that the data cannot distinguish do not cancel each other.
  [[nodiscard]] Eigen::VectorXd column(const Multiquadric& shape, Eigen::Index base) const {
    const ForceField one{{{1, shape.epsilon, shape.center}}};
    Eigen::VectorXd result = Eigen::VectorXd::Zero(matrix_.rows());
    for (Eigen::Index i = 0; i < objective_.forces.cols(); ++i) {
      result.segment<3>(3 * i) = force(one, objective_.displacements.col(i));
    }
    result[objective_.forces.size() + base] =
        kRidge * std::sqrt(static_cast<double>(objective_.forces.cols()));
    return result;
  }

  // One more column reduces the squared error by the residual's component along the part of the
  // column that is orthogonal to the others.
  void rank_places() {
    const auto old = static_cast<Eigen::Index>(field_.bases.size());
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(matrix_.leftCols(old));
    const Eigen::MatrixXd q = qr.householderQ() * Eigen::MatrixXd::Identity(matrix_.rows(), old);
    const Eigen::VectorXd residual = target_ - q * (q.transpose() * target_);
    for (const double multiple : kStartMultiples) {
      for (Eigen::Index i = 0; i < objective_.displacements.cols(); ++i) {
        const Eigen::Vector3d center = multiple * objective_.displacements.col(i);
        Eigen::VectorXd across = column({1, epsilon_, center}, old);
        across -= q * (q.transpose() * across);
        const double part = residual.dot(across);
        places_.push_back({part * part / across.squaredNorm(), center});
      }
    }
    std::stable_sort(places_.begin(), places_.end(),
                     [](const Place& l, const Place& r) { return l.gain > r.gain; });
  }

  [[nodiscard]] ForceField with_base_at(const Eigen::Vector3d& center) {
    const auto old = static_cast<Eigen::Index>(field_.bases.size());
    matrix_.col(old) = column({1, epsilon_, center}, old);
    const Eigen::VectorXd weights = matrix_.colPivHouseholderQr().solve(target_);
    ForceField field = field_;
    field.bases.push_back({0, epsilon_, center});
    for (Eigen::Index k = 0; k <= old; ++k) {
      field.bases[static_cast<std::size_t>(k)].weight = weights[k];
    }
    return field;
  }

  const FieldObjective& objective_;
  const ForceField& field_;
  double epsilon_;
  Eigen::VectorXd target_;
  Eigen::MatrixXd matrix_;
  std::vector<Place> places_;
};

double mean_squared_error(const FieldObjective& objective, const ForceField& field) {
  double sum = 0;
  for (Eigen::Index i = 0; i < objective.forces.cols(); ++i) {
    sum += (force(field, objective.displacements.col(i)) - objective.forces.col(i)).squaredNorm();
  }
  return sum / static_cast<double>(objective.forces.cols());
}

// Minimises the error from a start, subject to the constraints.
LocalFit refit(const FieldObjective& objective, const ForceField& start,
               const FieldConstraints& constraints) {
  const FieldSolution solution = solve_field(objective, to_parameters(start), constraints);
  LocalFit result;
  result.iterations = solution.iterations;
  if (!solution.parameters.allFinite()) return result;
  ForceField found = to_field(solution.parameters);
  if (!(smallest_stiffness(found) >= 0)) return result;
  result.rms = std::sqrt(mean_squared_error(objective, found));
  result.field = std::move(found);
  result.stop = solution.converged ? FitStop::max_bases : FitStop::not_converged;
  return result;
}

// Bayesian information criterion; lower is better. In units of the data.
double information_criterion(const FieldObjective& objective, const ForceField& field,
                             const FieldConstraints& constraints) {
  const double values = static_cast<double>(objective.forces.size());
  const double parameters =
      (constraints.free_epsilon ? 5.0 : 4.0) * static_cast<double>(field.bases.size());
  const double error = std::max(mean_squared_error(objective, field), kExact * kExact);
  return values * std::log(error) + parameters * std::log(values);
}

struct Step {
  ForceField field;
  double criterion = std::numeric_limits<double>::infinity();
  bool converged = false;
};

// Adds one base and optimises all. A solve that ran out of iterations counts as well, because its
// result is valid, though perhaps not optimal.
Step add_base(const FieldObjective& objective, const ForceField& field, double criterion,
              const LocalFitOptions& options, int& iterations) {
  Starts starts(objective, field, options.epsilon);
  Step best;
  for (int n = 0; n < kMaxStarts; ++n) {
    if (n >= kMinStarts && best.converged && best.criterion < criterion) break;
    const std::optional<ForceField> start = starts.select(n);
    if (!start) break;
    const LocalFit found = refit(objective, *start, options.constraints);
    iterations += found.iterations;
    if (found.field.bases.empty()) continue;
    const double found_criterion =
        information_criterion(objective, found.field, options.constraints);
    if (found_criterion < best.criterion) {
      best = {found.field, found_criterion, found.stop != FitStop::not_converged};
    }
  }
  return best;
}

}  // namespace

double smallest_stiffness(const ForceField& field) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(
      stiffness(field, Eigen::Vector3d::Zero()), Eigen::EigenvaluesOnly);
  return eigen.eigenvalues()[0];
}

LocalFit fit_local(const FieldObjective& objective, const LocalFitOptions& options) {
  const Eigen::Index determined = std::max<Eigen::Index>(1, objective.forces.size() / 4);
  const Eigen::Index most = std::min<Eigen::Index>(options.max_bases, determined);
  LocalFit result;
  result.stop = FitStop::max_bases;
  double criterion = information_criterion(objective, result.field, options.constraints);
  bool converged = true;
  for (Eigen::Index bases = 1; bases <= most; ++bases) {
    Step step = add_base(objective, result.field, criterion, options, result.iterations);
    if (!(step.criterion < criterion)) {
      result.stop = FitStop::no_gain;
      break;
    }
    criterion = step.criterion;
    converged = step.converged;
    result.field = std::move(step.field);
    result.rms = std::sqrt(mean_squared_error(objective, result.field));
    if (result.rms <= std::max(options.accuracy, kExact)) {
      result.stop = FitStop::accurate;
      break;
    }
  }
  if (!converged) result.stop = FitStop::not_converged;
  result.rms = std::sqrt(mean_squared_error(objective, result.field));
  return result;
}

CertifiedFit fit_certified(const FieldObjective& objective, const LocalFitOptions& options,
                           const ReachableVolume& volume) {
  LocalFitOptions certain = options;
  certain.constraints.least_stiffness = kLeastStiffness;
  certain.constraints.least_secant = kLeastSecant;
  CertifiedFit result;
  result.fit = fit_local(objective, certain);
  result.certificate = certify_passivity(result.fit.field, volume);
  while (!is_passive(result.certificate) && result.repairs < kMaxRepairs) {
    // A constraint helps only where the certificate has found too little energy, not where the
    // proof alone has failed.
    if (!(result.certificate.weakest_stiffness < kLeastSecant / 2)) break;
    if (result.certificate.weakest == Eigen::Vector3d::Zero()) break;
    certain.constraints.places.push_back(result.certificate.weakest);
    LocalFit repaired = refit(objective, result.fit.field, certain.constraints);
    ++result.repairs;
    repaired.iterations += result.fit.iterations;
    if (repaired.field.bases.empty()) break;
    if (repaired.stop != FitStop::not_converged) repaired.stop = result.fit.stop;
    result.fit = std::move(repaired);
    result.certificate = certify_passivity(result.fit.field, volume);
  }
  return result;
}

}  // namespace palpate::haptics
