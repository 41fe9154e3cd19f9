// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "field/energy_bound.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::haptics {
namespace {

using Vector = std::array<RoundedNumber, 3>;
using Symmetric = std::array<RoundedNumber, 6>;

// More than the relative rounding error of a few hundred operations on positive numbers.
constexpr double kPositiveSlack = 1e-12;
// >= 2 / sqrt(3), the maximum of 3 t (1 - t^2): along a unit vector h, the third derivative of
// s = sqrt(|d|^2 + epsilon^2) is -3 t (|h|^2 - t^2) / s^2 with t = d.h / s, |t| < 1.
constexpr double kThirdDerivative = 1.1547005383793;
// Amount by which eigenvalues from plain arithmetic are lowered before they are proven, relative to
// the largest entry; far above their rounding error.
constexpr double kEigenvalueSlack = 1e-12;
// Share of the smallest stiffness at zero that remains in the safe ball.
constexpr double kSafePart = 0.25;

Vector exact(const Eigen::Vector3d& v) { return {{{v[0]}, {v[1]}, {v[2]}}}; }

RoundedNumber dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

RoundedNumber square(const RoundedNumber& a) { return a * a; }

RoundedNumber norm(const Vector& a) { return sqrt(dot(a, a)); }

// Returns true if A - shift I is provably positive semi-definite, by the pivots of its LDL^T.
bool is_above(const Symmetric& a, double shift) {
  const RoundedNumber lowered{shift};
  const RoundedNumber d0 = a[0] - lowered;
  if (!(d0.lower() > 0)) return false;
  const RoundedNumber l10 = a[1] / d0, l20 = a[3] / d0;
  const RoundedNumber d1 = a[2] - lowered - l10 * a[1];
  if (!(d1.lower() > 0)) return false;
  const RoundedNumber rest = a[4] - l20 * a[1];
  return (a[5] - lowered - l20 * a[3] - rest / d1 * rest).lower() >= 0;
}

// A proven lower bound of the smallest eigenvalue.
double smallest_eigenvalue(const Symmetric& a) {
  Eigen::Matrix3d values;
  values << a[0].value, a[1].value, a[3].value,  //
      a[1].value, a[2].value, a[4].value,        //
      a[3].value, a[4].value, a[5].value;
  double size = 0, error = 0;
  for (const RoundedNumber& entry : a) {
    size = std::max(size, std::abs(entry.value));
    error = std::max(error, entry.error);
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
  eigen.computeDirect(values, Eigen::EigenvaluesOnly);
  // computeDirect loses half of the digits of close eigenvalues: the second try allows for that.
  for (const double slack : {kEigenvalueSlack, std::sqrt(kEigenvalueSlack)}) {
    const double shift = eigen.eigenvalues()[0] - slack * size - 4 * error;
    if (is_above(a, shift)) return shift;
  }
  return -std::numeric_limits<double>::infinity();
}

}  // namespace

EnergyBound::EnergyBound(const ForceField& field, double radius, double number_tolerance)
    : radius_(radius), margin_(0) {
  for (const Multiquadric& multiquadric : field.bases) {
    Base base;
    base.ridge = is_ridge(multiquadric);
    base.weight = multiquadric.weight;
    base.epsilon_squared = square({multiquadric.epsilon});
    base.center = exact(multiquadric.center);
    RoundedNumber distance = norm(base.center);
    if (base.ridge) {
      const Vector ridge = exact(multiquadric.ridge);
      const RoundedNumber length = norm(ridge);
      for (std::size_t i = 0; i < 3; ++i) base.normal[i] = length * ridge[i];
      base.offset = distance = dot(base.normal, base.center);
      const RoundedNumber steepest = square(length);
      base.steepest = std::max(1.0, (steepest * square(steepest)).upper());
    }
    base.at_zero = sqrt(square(distance) + base.epsilon_squared);
    for (std::size_t i = 0; i < 3; ++i) {
      base.slope_at_zero[i] =
          -(base.ridge ? base.offset * base.normal[i] : base.center[i]) / base.at_zero;
    }
    // Lower bound of the root s in the whole ball.
    const double clear = std::max(0.0, std::abs(distance.value) - distance.error - radius);
    const double s = std::sqrt(clear * clear + base.epsilon_squared.lower());
    const double reach = norm(base.center).upper() + multiquadric.epsilon;
    // |dH/dw| <= 1 / s, |dH/dg| <= kThirdDerivative / s^2, |dH/d epsilon| <= 2 / s; rotating a
    // ridge changes both of its factors, 2 / s, and d by |x - g|. Twice the sum covers rounding and
    // second-order terms.
    double change = 3 / s + kThirdDerivative * reach / (s * s);
    if (base.ridge) change += 2 / s + kThirdDerivative * (radius + reach) / (s * s);
    margin_ += 2 * number_tolerance * std::abs(base.weight) * change;
    bases_.push_back(base);
  }
}

// Contribution of a base and its root s at a place.
struct EnergyBound::Root {
  RoundedNumber s;
  Vector slope;              // grad s
  RoundedNumber difference;  // s(x) - s(0), without cancellation near zero
  double clear;              // lower bound of |P (x - g)| within the reach

  Root(const Base& base, const Vector& x, double reach) {
    if (base.ridge) {
      const RoundedNumber along = dot(base.normal, x), d = along - base.offset;
      s = sqrt(square(d) + base.epsilon_squared);
      for (std::size_t i = 0; i < 3; ++i) slope[i] = d / s * base.normal[i];
      difference = along * (d - base.offset) / (s + base.at_zero);
      clear = std::abs(d.value) - d.error;
    } else {
      Vector d, sum;
      for (std::size_t i = 0; i < 3; ++i) d[i] = x[i] - base.center[i];
      for (std::size_t i = 0; i < 3; ++i) sum[i] = d[i] - base.center[i];
      s = sqrt(dot(d, d) + base.epsilon_squared);
      for (std::size_t i = 0; i < 3; ++i) slope[i] = d[i] / s;
      difference = dot(x, sum) / (s + base.at_zero);
      clear = norm(d).lower();
    }
    clear = std::max(
        0.0, (RoundedNumber{clear} - RoundedNumber{base.steepest} * RoundedNumber{reach}).lower());
  }
};

EnergyBound::Taylor EnergyBound::expand(const Eigen::Vector3d& place, double reach) const {
  const Vector x = exact(place);
  const RoundedNumber margin{margin_};
  Taylor result;
  result.value = -(margin * RoundedNumber{0.5} * dot(x, x));
  for (std::size_t i = 0; i < 3; ++i) result.gradient[i] = -(margin * x[i]);
  for (const std::size_t diagonal : {0, 2, 5}) result.hessian[diagonal] = -margin;
  for (const Base& base : bases_) {
    const RoundedNumber weight{base.weight};
    const Root root(base, x, reach);
    result.value = result.value + weight * (root.difference - dot(base.slope_at_zero, x));
    const RoundedNumber second = weight / root.s;
    for (std::size_t i = 0, e = 0; i < 3; ++i) {
      result.gradient[i] = result.gradient[i] + weight * (root.slope[i] - base.slope_at_zero[i]);
      for (std::size_t j = 0; j <= i; ++j, ++e) {
        const RoundedNumber projected =
            base.ridge ? base.normal[i] * base.normal[j] : RoundedNumber{i == j ? 1.0 : 0.0};
        result.hessian[e] =
            result.hessian[e] + second * (projected - root.slope[i] * root.slope[j]);
      }
    }
    const double s_squared = (square({root.clear}) + base.epsilon_squared).lower();
    const double most = std::abs(base.weight) * base.steepest;
    result.third += most * kThirdDerivative / s_squared;
    if (base.weight < 0) result.concave += most / std::sqrt(s_squared);
  }
  result.third *= 1 + kPositiveSlack;
  result.concave = (result.concave + margin_) * (1 + kPositiveSlack);
  return result;
}

EnergyBound::InCell EnergyBound::in_cell(const Cell& cell) const {
  const RoundedNumber half_width{cell.half_width};
  const RoundedNumber reach{std::sqrt(3.0) * cell.half_width * (1 + kPositiveSlack)};
  const Taylor taylor = expand(cell.center, reach.value);
  // q(x + h) >= q + g.h + curvature / 2 |h|^2: Taylor expansion with the remainder of third or of
  // second order, whichever is better.
  const RoundedNumber remainder = RoundedNumber{taylor.third} * reach / RoundedNumber{3};
  const RoundedNumber curvature{std::max(
      (RoundedNumber{smallest_eigenvalue(taylor.hessian)} - remainder).lower(), -taylor.concave)};
  RoundedNumber fall, squared;
  for (const RoundedNumber& slope : taylor.gradient) {
    const RoundedNumber steepest{std::max(slope.upper(), -slope.lower())};
    fall = fall + steepest * half_width;
    squared = squared + square(steepest);
  }
  if (curvature.value > 0) {
    // -steepest r + curvature / 2 r^2 has its minimum at its vertex, or at the end of the cell.
    const RoundedNumber steepest{sqrt(squared).upper()};
    const RoundedNumber parabola =
        steepest.value >= (curvature * reach).upper()
            ? steepest * reach - curvature * RoundedNumber{0.5} * square(reach)
            : squared / (RoundedNumber{2} * curvature);
    fall = {std::min(fall.upper(), parabola.upper())};
  } else {
    fall = fall - curvature * RoundedNumber{0.5} * square(reach);
  }
  return {taylor.value, (taylor.value - fall).lower()};
}

RoundedNumber EnergyBound::energy(const Eigen::Vector3d& place) const {
  const Vector x = exact(place);
  return expand(place, 0).value + RoundedNumber{margin_} * RoundedNumber{0.5} * dot(x, x);
}

double EnergyBound::safe_radius() const {
  // q(x) >= smallest / 2 |x|^2 - third / 6 |x|^3, as value and gradient are exactly zero at zero.
  const double smallest =
      smallest_eigenvalue(expand(Eigen::Vector3d::Zero(), 0).hessian) * (1 - kSafePart);
  const auto safe = [&](double radius) {
    const double third = expand(Eigen::Vector3d::Zero(), radius).third;
    return (RoundedNumber{smallest} -
            RoundedNumber{third} * RoundedNumber{radius} / RoundedNumber{3})
               .lower() >= 0;
  };
  if (safe(radius_)) return radius_;
  // The condition fails beyond some radius: halving finds it up to a factor of two; then it is
  // refined, with each step inside the safe range.
  double radius = radius_;
  constexpr int kHalvings = 40;  // 1e-12 of the volume
  int halvings = 0;
  while (halvings < kHalvings && !safe(radius /= 2)) ++halvings;
  if (halvings == kHalvings) return 0;
  for (double step = radius / 2; step > radius / 16; step /= 2) {
    if (safe(radius + step)) radius += step;
  }
  return radius;
}

}  // namespace palpate::haptics
