// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/strip_model.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "identify/strip_energy.h"
#include "palpate/core/error.h"
#include "palpate/core/require.h"

namespace palpate::haptics {
namespace {

constexpr int kMaxStripIterations = 200;
/// The equilibrium is found if the residual force <= this * the sum of the magnitudes of its terms;
/// 1e-12 is some hundred roundings.
constexpr double kBalanceRelTol = 1e-12;
/// Smallest eigenvalue of Newton's matrix relative to its largest, so that a step is always
/// downhill.
constexpr double kSmallestEigenvalue = 1e-9;
/// A step is halved down to this fraction; below it, rounding decides which energy is smaller.
constexpr double kSmallestPart = 1e-9;

Strip sound_strip(const StripModel& model, const probing::Contact& contact,
                  const Eigen::Vector3d& given) {
  Strip strip = strip_at(model, contact);
  if (!is_sound(strip)) {
    throw InvalidInput(fmt::format(
        "strip: contact {} has segments of {} and {} mm, tension {} N and axial stiffness {} N; it "
        "has to lie between the supports, where the sheet's width factor is > 0, with its normal "
        "across the axis.",
        contact.id, strip.length_low, strip.length_high, strip.tension, strip.axial));
  }
  require("StripModel::lateral_stiffness", model.lateral_stiffness, at_least(0), "N/mm");
  require("StripModel::compliance", model.compliance, at_least(0), "mm/N");
  if (!given.allFinite()) throw InvalidInput("strip: a displacement or force is not finite.");
  return strip;
}

/// Solves with a Hessian; if it has directions of negative or very small curvature, with a similar
/// positive definite matrix.
Eigen::Vector3d downhill_inverse(const Eigen::Matrix3d& hessian, const Eigen::Vector3d& gradient) {
  const Eigen::LLT<Eigen::Matrix3d> cholesky(hessian);
  if (cholesky.info() == Eigen::Success && cholesky.rcond() > kSmallestEigenvalue) {
    return cholesky.solve(gradient);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(hessian);
  const Eigen::Vector3d curvature = eigen.eigenvalues().cwiseAbs();
  const double least =
      std::max(kSmallestEigenvalue * curvature.maxCoeff(), std::numeric_limits<double>::min());
  return eigen.eigenvectors() *
         (eigen.eigenvectors().transpose() * gradient).cwiseQuotient(curvature.cwiseMax(least));
}

/// Newton's method with line search for the minimum of a function of e, given by its value,
/// gradient, Hessian, and the size of the gradient's terms.
template <typename Value, typename Gradient, typename Hessian>
std::optional<Eigen::Vector3d> minimize(Eigen::Vector3d e, double size, const Value& value,
                                        const Gradient& gradient_at, const Hessian& hessian_at) {
  for (int i = 0; i < kMaxStripIterations; ++i) {
    const Eigen::Vector3d unbalanced = gradient_at(e);
    const Eigen::Matrix3d hessian_here = hessian_at(e);
    const double largest = hessian_here.norm();
    if (unbalanced.norm() <= kBalanceRelTol * (size + largest * e.norm())) return e;
    const Eigen::Vector3d step = -downhill_inverse(hessian_here, unbalanced);
    double part = 1;
    const double here = value(e);
    // Close to the minimum the energy is dominated by rounding, so compare the gradient.
    while (part > kSmallestPart && !(value(e + part * step) < here) &&
           !(gradient_at(e + part * step).norm() < unbalanced.norm())) {
      part /= 2;
    }
    e += part * step;
  }
  return std::nullopt;
}

Eigen::Vector3d found_or_throw(const std::optional<Eigen::Vector3d>& found) {
  if (found) return *found;
  throw SolverError(
      "strip: no equilibrium was found; is the force or the displacement far beyond "
      "the strip's size?");
}

/// e of a displacement d (local): minimum of compliance U(e) + |d - e|^2 / 2.
Eigen::Vector3d sheet_displacement(const Strip& strip, double compliance,
                                   const Eigen::Vector3d& d) {
  if (compliance == 0) return d;
  return found_or_throw(minimize(
      d / (1 + compliance * hessian(strip, Eigen::Vector3d::Zero()).norm()), d.norm(),
      [&](const Eigen::Vector3d& e) {
        return compliance * energy(strip, e) + 0.5 * (d - e).squaredNorm();
      },
      [&](const Eigen::Vector3d& e) -> Eigen::Vector3d {
        return compliance * gradient(strip, e) + e - d;
      },
      [&](const Eigen::Vector3d& e) -> Eigen::Matrix3d {
        return compliance * hessian(strip, e) + Eigen::Matrix3d::Identity();
      }));
}

}  // namespace

Strip strip_at(const StripModel& model, const probing::Contact& contact) {
  const Eigen::Vector3d inward = -contact.normal.normalized();
  const Eigen::Vector3d along = (model.axis - model.axis.dot(inward) * inward).normalized();
  const Eigen::Vector3d from_origin = contact.position - model.origin;
  const double x = model.axis.dot(from_origin), q = model.across.dot(from_origin);
  const double width = 1 + model.slope * q + model.curvature * q * q;
  Strip strip;
  strip.frame << along.transpose(), inward.cross(along).transpose(), inward.transpose();
  strip.length_low = x - model.low_support;
  strip.length_high = model.high_support - x;
  strip.tension = width * model.tension;
  strip.axial = width * model.axial_stiffness;
  strip.lateral = model.lateral_stiffness;
  if (!(width > 0)) strip.tension = strip.axial = -1;
  return strip;
}

bool is_sound(const Strip& strip) {
  return strip.frame.allFinite() && strip.length_low > 0 && strip.length_high > 0 &&
         strip.tension >= 0 && strip.axial >= 0 && std::isfinite(strip.lateral);
}

double energy(const Strip& strip, const Eigen::Vector3d& e) {
  double sum = 0.5 * strip.lateral * e.y() * e.y();
  for (const double offset : {strip.length_low, -strip.length_high}) {
    const double length = std::abs(offset);
    const double stretch = (e + offset * Eigen::Vector3d::UnitX()).norm() - length;
    sum += strip.tension * stretch + strip.axial / (2 * length) * stretch * stretch;
  }
  return sum;
}

Eigen::Vector3d gradient(const Strip& strip, const Eigen::Vector3d& e) {
  Eigen::Vector3d sum(0, strip.lateral * e.y(), 0);
  for (const double offset : {strip.length_low, -strip.length_high}) {
    const double length = std::abs(offset);
    const Eigen::Vector3d segment = e + offset * Eigen::Vector3d::UnitX();
    const double stretched = segment.norm();
    sum += (strip.tension + strip.axial * (stretched - length) / length) / stretched * segment;
  }
  return sum;
}

Eigen::Matrix3d hessian(const Strip& strip, const Eigen::Vector3d& e) {
  Eigen::Matrix3d sum = Eigen::Vector3d(0, strip.lateral, 0).asDiagonal();
  for (const double offset : {strip.length_low, -strip.length_high}) {
    const double length = std::abs(offset);
    const Eigen::Vector3d segment = e + offset * Eigen::Vector3d::UnitX();
    const double stretched = segment.norm();
    const Eigen::Matrix3d along = segment * segment.transpose() / (stretched * stretched);
    sum += strip.axial / length * along +
           (strip.tension + strip.axial * (stretched - length) / length) / stretched *
               (Eigen::Matrix3d::Identity() - along);
  }
  return sum;
}

std::optional<Eigen::Vector3d> find_equilibrium(const Strip& strip, const Eigen::Vector3d& force,
                                                const Eigen::Vector3d& near) {
  const auto from = [&](const Eigen::Vector3d& start) {
    return minimize(
        start, force.norm(),
        [&](const Eigen::Vector3d& e) { return energy(strip, e) - force.dot(e); },
        [&](const Eigen::Vector3d& e) -> Eigen::Vector3d { return gradient(strip, e) - force; },
        [&](const Eigen::Vector3d& e) -> Eigen::Matrix3d { return hessian(strip, e); });
  };
  const std::optional<Eigen::Vector3d> found = from(near);
  return found || near.isZero(0) ? found : from(Eigen::Vector3d::Zero());
}

double potential(const StripModel& model, const probing::Contact& contact,
                 const Eigen::Vector3d& displacement) {
  const Strip strip = sound_strip(model, contact, displacement);
  const Eigen::Vector3d e = sheet_displacement(strip, model.compliance, strip.frame * displacement);
  // |d - e|^2 / (2 compliance) without the division, which a stiff skin does not allow.
  return energy(strip, e) + 0.5 * model.compliance * gradient(strip, e).squaredNorm();
}

Eigen::Vector3d force(const StripModel& model, const probing::Contact& contact,
                      const Eigen::Vector3d& displacement) {
  const Strip strip = sound_strip(model, contact, displacement);
  return strip.frame.transpose() *
         gradient(strip, sheet_displacement(strip, model.compliance, strip.frame * displacement));
}

Eigen::Matrix3d stiffness(const StripModel& model, const probing::Contact& contact,
                          const Eigen::Vector3d& displacement) {
  const Strip strip = sound_strip(model, contact, displacement);
  const Eigen::Matrix3d h =
      hessian(strip, sheet_displacement(strip, model.compliance, strip.frame * displacement));
  const Eigen::Matrix3d local =
      (Eigen::Matrix3d::Identity() + model.compliance * h).ldlt().solve(h);
  return strip.frame.transpose() * (local + local.transpose()) / 2 * strip.frame;
}

Eigen::Vector3d displacement(const StripModel& model, const probing::Contact& contact,
                             const Eigen::Vector3d& force) {
  const Strip strip = sound_strip(model, contact, force);
  const Eigen::Vector3d f = strip.frame * force;
  const Eigen::Vector3d e = found_or_throw(find_equilibrium(strip, f));
  return strip.frame.transpose() * (e + model.compliance * f);
}

}  // namespace palpate::haptics
