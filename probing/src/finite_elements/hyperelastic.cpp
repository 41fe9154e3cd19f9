// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/hyperelastic.h"

#include <Eigen/Geometry>
#include <cmath>

#include "palpate/core/require.h"

namespace palpate::probing {
namespace {

using Matrix9 = Eigen::Matrix<double, 9, 9>;
using Vector9 = Eigen::Matrix<double, 9, 1>;

Vector9 as_vector(const Eigen::Matrix3d& m) { return Eigen::Map<const Vector9>(m.data()); }

}  // namespace

void check_hyperelastic(const Hyperelastic& material) {
  require("Hyperelastic::shear_modulus", material.shear_modulus, above(0).finite(), "N/mm^2");
  require("Hyperelastic::mooney_share", material.mooney_share, at_least(0).at_most(1));
  require("Hyperelastic::bulk_modulus", material.bulk_modulus,
          at_least(kLeastBulkRatio * material.shear_modulus)
              .at_most(kMostBulkRatio * material.shear_modulus),
          "N/mm^2");
}

double young_modulus(const Hyperelastic& material) {
  const double k = material.bulk_modulus, mu = material.shear_modulus;
  return 9 * k * mu / (3 * k + mu);
}

double poisson_ratio(const Hyperelastic& material) {
  const double k = material.bulk_modulus, mu = material.shear_modulus;
  return (3 * k - 2 * mu) / (2 * (3 * k + mu));
}

Eigen::Matrix3d cofactor(const Eigen::Matrix3d& a) {
  Eigen::Matrix3d result;
  result.col(0) = a.col(1).cross(a.col(2));
  result.col(1) = a.col(2).cross(a.col(0));
  result.col(2) = a.col(0).cross(a.col(1));
  return result;
}

Matrix9 tensor_cross_matrix(const Eigen::Matrix3d& a) {
  // Columns of A x B are a_2 x b_3 - a_3 x b_2 and so on, in cyclic order.
  const auto cross = [](const Eigen::Vector3d& v) {
    Eigen::Matrix3d m;
    m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return m;
  };
  const Eigen::Matrix3d c0 = cross(a.col(0)), c1 = cross(a.col(1)), c2 = cross(a.col(2));
  Matrix9 result = Matrix9::Zero();
  result.block<3, 3>(0, 6) = c1;
  result.block<3, 3>(0, 3) = -c2;
  result.block<3, 3>(3, 0) = c2;
  result.block<3, 3>(3, 6) = -c0;
  result.block<3, 3>(6, 3) = c0;
  result.block<3, 3>(6, 0) = -c1;
  return result;
}

IsochoricStress isochoric_stress(const Hyperelastic& material, const Eigen::Matrix3d& gradient) {
  const double c10 = (1 - material.mooney_share) * material.shear_modulus / 2;
  const double c01 = material.mooney_share * material.shear_modulus / 2;
  const Eigen::Matrix3d h = cofactor(gradient);
  const double j = gradient.col(0).dot(h.col(0));
  const double i1 = gradient.squaredNorm();
  const double scale = 1 / std::cbrt(j * j);  // J^(-2/3)
  const Matrix9 cross = tensor_cross_matrix(gradient);
  const Vector9 f = as_vector(gradient), hv = as_vector(h);

  IsochoricStress result;
  const double a = c10 * scale;
  result.stress = a * (2 * gradient - 2.0 / 3 * i1 / j * h);
  result.tangent =
      (10.0 / 9 * a * i1 / (j * j) * hv) * hv.transpose() - 2.0 / 3 * a * i1 / j * cross;
  result.tangent.diagonal().array() += 2 * a;
  const Matrix9 fh = f * hv.transpose();
  result.tangent -= 4.0 / 3 * a / j * (fh + fh.transpose());
  if (c01 > 0) {
    const double i2 = h.squaredNorm(), b = c01 * scale * scale;
    const Vector9 s = cross * hv;  // the same as (cof F) x F
    result.stress += b * (2 * Eigen::Map<const Eigen::Matrix3d>(s.data()) - 4.0 / 3 * i2 / j * h);
    const Matrix9 sh = s * hv.transpose();
    result.tangent += 2 * b * (cross.transpose() * cross + tensor_cross_matrix(h)) -
                      8.0 / 3 * b / j * (sh + sh.transpose()) +
                      (28.0 / 9 * b * i2 / (j * j) * hv) * hv.transpose() -
                      4.0 / 3 * b * i2 / j * cross;
  }
  return result;
}

double isochoric_energy(const Hyperelastic& material, const Eigen::Matrix3d& gradient) {
  const Eigen::Matrix3d h = cofactor(gradient);
  const double j = gradient.col(0).dot(h.col(0));
  const double scale = 1 / std::cbrt(j * j);
  return material.shear_modulus / 2 *
         ((1 - material.mooney_share) * (scale * gradient.squaredNorm() - 3) +
          material.mooney_share * (scale * scale * h.squaredNorm() - 3));
}

VolumetricStress volumetric_stress(const Hyperelastic& material, double volume_ratio) {
  const double k = material.bulk_modulus, j = volume_ratio;
  return {k / 4 * (j * j - 1 - 2 * std::log(j)), k / 2 * (j - 1 / j), k / 2 * (1 + 1 / (j * j))};
}

}  // namespace palpate::probing
