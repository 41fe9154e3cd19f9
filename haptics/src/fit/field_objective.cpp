// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/field_objective.h"

#include <cmath>
#include <vector>

#include "field/field_forces.h"

namespace palpate::haptics {
namespace {

// A multiquadric is the length of d = (x - g, epsilon) in four dimensions; q = d / |d| is its
// gradient.
struct BaseDerivatives {
  Eigen::Vector4d q;
  double s;

  BaseDerivatives(const Eigen::Ref<const Eigen::VectorXd>& parameters, Eigen::Index k,
                  const Eigen::Vector3d& x) {
    q << x - parameters.segment<3>(k + 1), parameters[k + 4];
    s = q.norm();
    q /= s;
  }
  /// dq/dd
  [[nodiscard]] Eigen::Matrix4d slope() const {
    return (Eigen::Matrix4d::Identity() - q * q.transpose()) / s;
  }
  [[nodiscard]] Eigen::Vector4d slope_times(const Eigen::Vector4d& r) const {
    return (r - q.dot(r) * q) / s;
  }
  /// d/dd (dq/dd r)
  [[nodiscard]] Eigen::Matrix4d curvature(const Eigen::Vector4d& r) const {
    const double qr = q.dot(r);
    return -(r * q.transpose() + q * r.transpose() + qr * Eigen::Matrix4d::Identity() -
             3 * qr * q * q.transpose()) /
           (s * s);
  }
};

std::vector<BaseDerivatives> derivatives_at_zero(
    const Eigen::Ref<const Eigen::VectorXd>& parameters) {
  std::vector<BaseDerivatives> result;
  for (Eigen::Index k = 0; k < parameters.size(); k += kBaseSize)
    result.emplace_back(parameters, k, Eigen::Vector3d::Zero());
  return result;
}

Eigen::Vector4d extended(const Eigen::Vector3d& v) { return {v[0], v[1], v[2], 0}; }

// dd/d(g, epsilon): d depends on minus the centre.
const Eigen::Vector4d kSigns(-1, -1, -1, 1);

Eigen::Matrix4d signed_sides(const Eigen::Matrix4d& m) {
  return kSigns.asDiagonal() * m * kSigns.asDiagonal();
}

Eigen::VectorXd weights_only(const Eigen::Ref<const Eigen::VectorXd>& parameters) {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(parameters.size());
  for (Eigen::Index k = 0; k < parameters.size(); k += kBaseSize) result[k] = parameters[k];
  return result;
}

// Adds the contribution of one base: its weight times a function of d, given with its derivatives.
void add_base(Eigen::Index k, double weight, double value, const Eigen::Vector4d& first,
              const Eigen::Matrix4d& second, FieldFunction& result) {
  const Eigen::Vector4d slope = kSigns.cwiseProduct(first);
  result.value += weight * value;
  result.gradient[k] = value;
  result.gradient.segment<4>(k + 1) = weight * slope;
  result.hessian.block<4, 1>(k + 1, k) = slope;
  result.hessian.block<1, 4>(k, k + 1) = slope.transpose();
  result.hessian.block<4, 4>(k + 1, k + 1) = weight * signed_sides(second);
}

FieldFunction zero_function(Eigen::Index size) {
  return {0, Eigen::VectorXd::Zero(size), Eigen::MatrixXd::Zero(size, size)};
}

}  // namespace

double FieldObjective::value(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  const Eigen::Matrix3Xd found = field_forces(to_field(parameters), displacements);
  double sum = 0;
  for (Eigen::Index i = 0; i < forces.cols(); ++i)
    sum += (found.col(i) - forces.col(i)).squaredNorm();
  return sum / (2 * static_cast<double>(forces.cols())) +
         weight_penalty / 2 * weights_only(parameters).squaredNorm();
}

Eigen::VectorXd FieldObjective::gradient(
    const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  const Eigen::Matrix3Xd found = field_forces(to_field(parameters), displacements);
  const std::vector<BaseDerivatives> at_zero = derivatives_at_zero(parameters);
  Eigen::VectorXd result = weight_penalty * weights_only(parameters);
  for (Eigen::Index i = 0; i < forces.cols(); ++i) {
    const Eigen::Vector4d residual =
        extended((found.col(i) - forces.col(i)) / static_cast<double>(forces.cols()));
    for (Eigen::Index k = 0; k < parameters.size(); k += kBaseSize) {
      const BaseDerivatives& zero = at_zero[static_cast<std::size_t>(k / kBaseSize)];
      const BaseDerivatives here(parameters, k, displacements.col(i));
      result[k] += (here.q - zero.q).dot(residual);
      result.segment<4>(k + 1) += parameters[k] * kSigns.cwiseProduct(here.slope_times(residual) -
                                                                      zero.slope_times(residual));
    }
  }
  return result;
}

Eigen::MatrixXd FieldObjective::hessian(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
  const Eigen::Matrix3Xd found = field_forces(to_field(parameters), displacements);
  const std::vector<BaseDerivatives> at_zero = derivatives_at_zero(parameters);
  const Eigen::Index size = parameters.size();
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(size, size);
  Eigen::MatrixXd jacobian(size, 3 * forces.cols());  // one column per residual component
  for (Eigen::Index i = 0; i < forces.cols(); ++i) {
    const Eigen::Vector4d residual = extended(found.col(i) - forces.col(i));
    for (Eigen::Index k = 0; k < size; k += kBaseSize) {
      const BaseDerivatives& zero = at_zero[static_cast<std::size_t>(k / kBaseSize)];
      const BaseDerivatives here(parameters, k, displacements.col(i));
      const Eigen::Matrix4d slope = kSigns.asDiagonal() * (here.slope() - zero.slope());
      jacobian.block<1, 3>(k, 3 * i) = (here.q - zero.q).head<3>().transpose();
      jacobian.block<4, 3>(k + 1, 3 * i) = parameters[k] * slope.leftCols<3>();
      result.block<4, 1>(k + 1, k) += slope * residual;
      result.block<4, 4>(k + 1, k + 1) +=
          parameters[k] * signed_sides(here.curvature(residual) - zero.curvature(residual));
    }
  }
  result.selfadjointView<Eigen::Lower>().rankUpdate(jacobian);
  result /= static_cast<double>(forces.cols());
  for (Eigen::Index k = 0; k < size; k += kBaseSize) result(k, k) += weight_penalty;
  return result.selfadjointView<Eigen::Lower>();
}

FieldFunction stiffness_at_zero(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                                const Eigen::Matrix3d& factor) {
  FieldFunction result = zero_function(parameters.size());
  Eigen::Matrix4d f = Eigen::Matrix4d::Zero();
  f.topLeftCorner<3, 3>() = factor;
  const double trace = factor.trace();
  for (Eigen::Index k = 0; k < parameters.size(); k += kBaseSize) {
    const BaseDerivatives zero(parameters, k, Eigen::Vector3d::Zero());
    const Eigen::Vector4d q = zero.q, fq = f * q;
    const double qfq = q.dot(fq), s = zero.s;
    const Eigen::Vector4d first = (3 * qfq * q - trace * q - 2 * fq) / (s * s);
    const Eigen::Matrix4d second = (-2 * f + (3 * qfq - trace) * Eigen::Matrix4d::Identity() +
                                    (3 * trace - 15 * qfq) * q * q.transpose() +
                                    6 * (fq * q.transpose() + q * fq.transpose())) /
                                   (s * s * s);
    add_base(k, parameters[k], (trace - qfq) / s, first, second, result);
  }
  return result;
}

FieldFunction energy_at(const Eigen::Ref<const Eigen::VectorXd>& parameters,
                        const Eigen::Vector3d& place) {
  FieldFunction result = zero_function(parameters.size());
  const Eigen::Vector4d x = extended(place);
  for (Eigen::Index k = 0; k < parameters.size(); k += kBaseSize) {
    const BaseDerivatives zero(parameters, k, Eigen::Vector3d::Zero());
    const BaseDerivatives here(parameters, k, place);
    add_base(k, parameters[k], here.s - zero.s - zero.q.dot(x),
             here.q - zero.q - zero.slope_times(x), here.slope() - zero.slope() - zero.curvature(x),
             result);
  }
  return result;
}

ForceField to_field(const Eigen::Ref<const Eigen::VectorXd>& parameters) {
  ForceField field;
  for (Eigen::Index k = 0; k < parameters.size(); k += kBaseSize) {
    field.bases.push_back({parameters[k], parameters[k + 4], parameters.segment<3>(k + 1)});
  }
  return field;
}

Eigen::VectorXd to_parameters(const ForceField& field) {
  Eigen::VectorXd parameters(kBaseSize * static_cast<Eigen::Index>(field.bases.size()));
  Eigen::Index k = 0;
  for (const Multiquadric& base : field.bases) {
    parameters.segment<kBaseSize>(k) << base.weight, base.center, base.epsilon;
    k += kBaseSize;
  }
  return parameters;
}

}  // namespace palpate::haptics
