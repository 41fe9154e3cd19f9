// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "finite_elements/quadratic_tetrahedron.h"

#include <Eigen/LU>
#include <algorithm>

namespace palpate::probing {
namespace {

using Barycentric = Eigen::Vector4d;

// Derivatives of the ten shape functions by the barycentric coordinates.
Eigen::Matrix<double, 4, 10> barycentric_gradients(const Barycentric& l) {
  Eigen::Matrix<double, 4, 10> result = Eigen::Matrix<double, 4, 10>::Zero();
  for (int a = 0; a < 4; ++a) result(a, a) = 4 * l[a] - 1;
  for (int e = 0; e < 6; ++e) {
    result(kEdgeCorners[e][0], 4 + e) = 4 * l[kEdgeCorners[e][1]];
    result(kEdgeCorners[e][1], 4 + e) = 4 * l[kEdgeCorners[e][0]];
  }
  return result;
}

// Rows: derivatives by the last three barycentric coordinates, the first being one minus them.
ElementNodes reference_gradients(const Barycentric& l) {
  const Eigen::Matrix<double, 4, 10> all = barycentric_gradients(l);
  ElementNodes result = all.bottomRows<3>();
  result.rowwise() -= all.row(0);
  return result;
}

Barycentric quadrature_point(int k) {
  constexpr double kNear = 0.58541019662496845446, kFar = 0.13819660112501051518;
  Barycentric l = Barycentric::Constant(kFar);
  l[k] = kNear;
  return l;
}

double jacobian_at(const ElementNodes& nodes, const Barycentric& l) {
  return Eigen::Matrix3d(nodes * reference_gradients(l).transpose()).determinant();
}

struct PointKinematics {
  Eigen::Matrix3d gradient, cofactor;
  double ratio = 0;
};

struct ElementKinematics {
  std::array<PointKinematics, 4> at;
  double mean_ratio = 0;
  double volume = 0;
  bool valid = true;
};

ElementKinematics kinematics(const TetrahedronPoints& points, const ElementNodes& positions) {
  ElementKinematics result;
  double deformed = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    PointKinematics& at = result.at[k];
    at.gradient = positions * points[k].gradients.transpose();
    at.cofactor = cofactor(at.gradient);
    at.ratio = at.gradient.col(0).dot(at.cofactor.col(0));
    result.valid &= at.ratio > 0;
    deformed += points[k].weight * at.ratio;
    result.volume += points[k].weight;
  }
  result.mean_ratio = deformed / result.volume;
  return result;
}

}  // namespace

Eigen::Matrix<double, 10, 1> shape_functions(const Eigen::Vector4d& place) {
  Eigen::Matrix<double, 10, 1> result;
  for (int a = 0; a < 4; ++a) result[a] = place[a] * (2 * place[a] - 1);
  for (int e = 0; e < 6; ++e)
    result[4 + e] = 4 * place[kEdgeCorners[e][0]] * place[kEdgeCorners[e][1]];
  return result;
}

TetrahedronPoints tetrahedron_points(const ElementNodes& nodes) {
  constexpr double kWeight = 1.0 / 24;
  TetrahedronPoints points;
  for (int k = 0; k < 4; ++k) {
    const ElementNodes reference = reference_gradients(quadrature_point(k));
    const Eigen::Matrix3d jacobian = nodes * reference.transpose();
    const double determinant = jacobian.determinant();
    TetrahedronPoint& point = points[static_cast<std::size_t>(k)];
    point.gradients = jacobian.transpose().inverse() * reference;
    point.weight = kWeight * determinant;
  }
  return points;
}

double shape_quality(const ElementNodes& nodes) {
  constexpr double kHalf = 0.5;
  double least = 0, sum = 0;
  const auto take = [&](const Barycentric& l, bool counts) {
    const double jacobian = jacobian_at(nodes, l);
    least = std::min(least, jacobian);
    if (counts) sum += jacobian;
    return jacobian;
  };
  least = take(quadrature_point(0), true);
  for (int k = 1; k < 4; ++k) take(quadrature_point(k), true);
  for (int a = 0; a < 4; ++a) {
    take(Barycentric::Unit(a), false);
    for (int b = 0; b < a; ++b) take(kHalf * (Barycentric::Unit(a) + Barycentric::Unit(b)), false);
  }
  // Not a number and no volume at all are as bad as inverted.
  return sum > 0 ? least / (sum / 4) : -1;
}

ElementForce element_force(const TetrahedronPoints& points, const Hyperelastic& material,
                           const ElementNodes& positions) {
  ElementForce result;
  const ElementKinematics k = kinematics(points, positions);
  result.valid = k.valid;
  if (!k.valid) return result;
  const VolumetricStress volumetric = volumetric_stress(material, k.mean_ratio);
  result.energy = k.volume * volumetric.energy;
  result.force.setZero();
  const double c10 = (1 - material.mooney_share) * material.shear_modulus / 2;
  const double c01 = material.mooney_share * material.shear_modulus / 2;
  for (std::size_t p = 0; p < 4; ++p) {
    // The stress of `isochoric_stress`, without its tangent.
    const auto& [f, h, j] = k.at[p];
    const double i1 = f.squaredNorm(), scale = 1 / std::cbrt(j * j);
    const double a = c10 * scale;
    double energy = a * i1 - 3 * c10;
    Eigen::Matrix3d stress = (2 * a) * f + (volumetric.stress - 2.0 / 3 * a * i1 / j) * h;
    if (c01 > 0) {
      const double i2 = h.squaredNorm(), b = c01 * scale * scale;
      const Eigen::Matrix3d inner = i1 * f - f * (f.transpose() * f);  // (cof F) x F
      stress += (2 * b) * inner - (4.0 / 3 * b * i2 / j) * h;
      energy += b * i2 - 3 * c01;
    }
    result.energy += points[p].weight * energy;
    result.force += points[p].weight * stress * points[p].gradients;
  }
  return result;
}

ElementMatrix element_tangent(const TetrahedronPoints& points, const Hyperelastic& material,
                              const ElementNodes& positions) {
  using Rows = Eigen::Matrix<double, 9, 30>;
  const ElementKinematics k = kinematics(points, positions);
  const VolumetricStress volumetric = volumetric_stress(material, k.mean_ratio);
  ElementMatrix result = ElementMatrix::Zero();
  ElementNodes volume_gradient = ElementNodes::Zero();
  for (std::size_t p = 0; p < 4; ++p) {
    const auto& [f, h, j] = k.at[p];
    const ElementNodes& g = points[p].gradients;
    Eigen::Matrix<double, 9, 9> tangent = isochoric_stress(material, f).tangent;
    tangent += volumetric.stress * tensor_cross_matrix(f);
    tangent *= points[p].weight;
    Rows product;
    for (int a = 0; a < 10; ++a) {
      product.middleCols<3>(3 * a) = g(0, a) * tangent.leftCols<3>() +
                                     g(1, a) * tangent.middleCols<3>(3) +
                                     g(2, a) * tangent.rightCols<3>();
    }
    for (int a = 0; a < 10; ++a) {
      result.middleRows<3>(3 * a) += g(0, a) * product.topRows<3>() +
                                     g(1, a) * product.middleRows<3>(3) +
                                     g(2, a) * product.bottomRows<3>();
    }
    volume_gradient += points[p].weight * h * g;
  }
  const Eigen::Map<const Eigen::Matrix<double, 30, 1>> gradient(volume_gradient.data());
  result += (volumetric.tangent / k.volume * gradient) * gradient.transpose();
  return result;
}

}  // namespace palpate::probing
