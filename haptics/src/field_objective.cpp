// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "field_objective.h"

#include <cmath>

namespace palpate::haptics {
namespace {

// One multiquadric's unit vector q = d / s at a place, d = x - g, s^2 = |d|^2 + epsilon^2.
struct Base {
  Eigen::Vector3d q;
  double s;

  Base(const Eigen::Vector3d& d, double epsilon)
      : q(d), s(std::sqrt(d.squaredNorm() + epsilon * epsilon)) {
    q /= s;
  }
  /// dq/dx
  [[nodiscard]] Eigen::Matrix3d slope() const {
    return (Eigen::Matrix3d::Identity() - q * q.transpose()) / s;
  }
  [[nodiscard]] Eigen::Vector3d slope_times(const Eigen::Vector3d& r) const {
    return (r - q.dot(r) * q) / s;
  }
  /// d/dx (dq/dx r)
  [[nodiscard]] Eigen::Matrix3d curvature(const Eigen::Vector3d& r) const {
    const double qr = q.dot(r);
    return -(r * q.transpose() + q * r.transpose() + qr * Eigen::Matrix3d::Identity() -
             3 * qr * q * q.transpose()) /
           (s * s);
  }
};

Eigen::VectorXd weights_only(const Eigen::Ref<const Eigen::VectorXd>& parameters) {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(parameters.size());
  for (Eigen::Index k = 0; k < parameters.size(); k += 4) result[k] = parameters[k];
  return result;
}

}  // namespace

double FieldObjective::value(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  const ForceField field = to_field(parameters, epsilon);
  double sum = 0;
  for (Eigen::Index i = 0; i < forces.cols(); ++i) {
    sum += (force(field, displacements.col(i)) - forces.col(i)).squaredNorm();
  }
  return sum / (2 * static_cast<double>(forces.cols())) +
         weight_penalty / 2 * weights_only(parameters).squaredNorm();
}

Eigen::VectorXd FieldObjective::gradient(
    const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  const ForceField field = to_field(parameters, epsilon);
  Eigen::VectorXd result = weight_penalty * weights_only(parameters);
  for (Eigen::Index i = 0; i < forces.cols(); ++i) {
    const Eigen::Vector3d residual =
        (force(field, displacements.col(i)) - forces.col(i)) / static_cast<double>(forces.cols());
    for (Eigen::Index k = 0; 4 * k < parameters.size(); ++k) {
      const Eigen::Vector3d center = parameters.segment<3>(4 * k + 1);
      const Base zero(-center, epsilon);
      const Base here(displacements.col(i) - center, epsilon);
      result[4 * k] += (here.q - zero.q).dot(residual);
      result.segment<3>(4 * k + 1) +=
          parameters[4 * k] * (zero.slope_times(residual) - here.slope_times(residual));
    }
  }
  return result;
}

Eigen::MatrixXd FieldObjective::hessian(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  const ForceField field = to_field(parameters, epsilon);
  const Eigen::Index size = parameters.size();
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(size, size);
  Eigen::MatrixXd jacobian(size, 3 * forces.cols());  // a column a residual component
  for (Eigen::Index i = 0; i < forces.cols(); ++i) {
    const Eigen::Vector3d residual = force(field, displacements.col(i)) - forces.col(i);
    for (Eigen::Index k = 0; 4 * k < parameters.size(); ++k) {
      const Eigen::Vector3d center = parameters.segment<3>(4 * k + 1);
      const Base zero(-center, epsilon);
      const Base here(displacements.col(i) - center, epsilon);
      const Eigen::Matrix3d slope = zero.slope() - here.slope();
      jacobian.block<1, 3>(4 * k, 3 * i) = (here.q - zero.q).transpose();
      jacobian.block<3, 3>(4 * k + 1, 3 * i) = parameters[4 * k] * slope;
      result.block<3, 1>(4 * k + 1, 4 * k) += slope * residual;
      result.block<3, 3>(4 * k + 1, 4 * k + 1) +=
          parameters[4 * k] * (here.curvature(residual) - zero.curvature(residual));
    }
  }
  result.selfadjointView<Eigen::Lower>().rankUpdate(jacobian);
  result /= static_cast<double>(forces.cols());
  for (Eigen::Index k = 0; k < size; k += 4) result(k, k) += weight_penalty;
  return result.selfadjointView<Eigen::Lower>();
}

FieldObjective::Contraction FieldObjective::stiffness_at_zero(
    const Eigen::Ref<const Eigen::VectorXd>& parameters, const Eigen::Matrix3d& factor) const {
  Contraction result;
  result.gradient = Eigen::VectorXd::Zero(parameters.size());
  result.hessian = Eigen::MatrixXd::Zero(parameters.size(), parameters.size());
  const double trace = factor.trace();
  for (Eigen::Index k = 0; 4 * k < parameters.size(); ++k) {
    const double weight = parameters[4 * k];
    const Base zero(-parameters.segment<3>(4 * k + 1), epsilon);
    const Eigen::Vector3d q = zero.q, fq = factor * q;
    const double qfq = q.dot(fq), s = zero.s;
    const double f = (trace - qfq) / s;
    // Derivatives of f with respect to the centre, d = -g.
    const Eigen::Vector3d first = (trace * q + 2 * fq - 3 * qfq * q) / (s * s);
    const Eigen::Matrix3d second = (-2 * factor + (3 * qfq - trace) * Eigen::Matrix3d::Identity() +
                                    (3 * trace - 15 * qfq) * q * q.transpose() +
                                    6 * (fq * q.transpose() + q * fq.transpose())) /
                                   (s * s * s);
    result.value += weight * f;
    result.gradient[4 * k] = f;
    result.gradient.segment<3>(4 * k + 1) = weight * first;
    result.hessian.block<3, 1>(4 * k + 1, 4 * k) = first;
    result.hessian.block<1, 3>(4 * k, 4 * k + 1) = first.transpose();
    result.hessian.block<3, 3>(4 * k + 1, 4 * k + 1) = weight * second;
  }
  return result;
}

ForceField to_field(const Eigen::Ref<const Eigen::VectorXd>& parameters, double epsilon) {
  ForceField field;
  for (Eigen::Index k = 0; k < parameters.size(); k += 4) {
    field.bases.push_back({parameters[k], epsilon, parameters.segment<3>(k + 1)});
  }
  return field;
}

Eigen::VectorXd to_parameters(const ForceField& field) {
  Eigen::VectorXd parameters(4 * static_cast<Eigen::Index>(field.bases.size()));
  Eigen::Index k = 0;
  for (const Multiquadric& base : field.bases) {
    parameters.segment<4>(k) << base.weight, base.center;
    k += 4;
  }
  return parameters;
}

}  // namespace palpate::haptics
