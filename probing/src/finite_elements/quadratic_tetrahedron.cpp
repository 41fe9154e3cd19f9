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

using Lanes = PackedPoints::Lanes;
using LaneMatrix = std::array<std::array<Lanes, 3>, 3>;  // a matrix of each point, by rows

LaneMatrix deformation(const PackedPoints& points, const ElementNodes& positions) {
  LaneMatrix f;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    Lanes x = positions(row, 0) * points.gradients[0][0],
          y = positions(row, 0) * points.gradients[0][1],
          z = positions(row, 0) * points.gradients[0][2];
    for (std::size_t a = 1; a < 10; ++a) {
      const double at = positions(row, static_cast<Eigen::Index>(a));
      x += at * points.gradients[a][0];
      y += at * points.gradients[a][1];
      z += at * points.gradients[a][2];
    }
    f[i] = {x, y, z};
  }
  return f;
}

LaneMatrix cofactor(const LaneMatrix& f) {
  LaneMatrix h;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t k1 = (k + 1) % 3, k2 = (k + 2) % 3;
      h[i][k] = f[i1][k1] * f[i2][k2] - f[i2][k1] * f[i1][k2];
    }
  }
  return h;
}

Lanes squared_norm(const LaneMatrix& m) {
  Lanes sum = Lanes::Zero();
  for (const auto& row : m)
    for (const Lanes& entry : row) sum += entry * entry;
  return sum;
}

// F F^T F
LaneMatrix times_own_square(const LaneMatrix& f) {
  LaneMatrix result;
  for (std::size_t i = 0; i < 3; ++i) {
    std::array<Lanes, 3> across;  // a row of F F^T
    for (std::size_t k = 0; k < 3; ++k)
      across[k] = f[i][0] * f[k][0] + f[i][1] * f[k][1] + f[i][2] * f[k][2];
    for (std::size_t k = 0; k < 3; ++k)
      result[i][k] = across[0] * f[0][k] + across[1] * f[1][k] + across[2] * f[2][k];
  }
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

PackedPoints::PackedPoints(const TetrahedronPoints& points) {
  for (std::size_t p = 0; p < 4; ++p) {
    const auto lane = static_cast<Eigen::Index>(p);
    weights[lane] = points[p].weight;
    for (std::size_t a = 0; a < 10; ++a)
      for (std::size_t i = 0; i < 3; ++i)
        gradients[a][i][lane] =
            points[p].gradients(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(a));
  }
}

ElementForce element_force(const PackedPoints& points, const Hyperelastic& material,
                           const ElementNodes& positions) {
  ElementForce result;
  const LaneMatrix f = deformation(points, positions);
  const LaneMatrix h = cofactor(f);
  const Lanes j = f[0][0] * h[0][0] + f[1][0] * h[1][0] + f[2][0] * h[2][0];
  result.valid = (j > 0).all();
  if (!result.valid) return result;
  const double volume = points.weights.sum();
  const VolumetricStress volumetric =
      volumetric_stress(material, (points.weights * j).sum() / volume);
  const double c10 = (1 - material.mooney_share) * material.shear_modulus / 2;
  const double c01 = material.mooney_share * material.shear_modulus / 2;
  // The stress of `isochoric_stress`, without its tangent, is a multiple of F, one of cof F, and
  // one of (cof F) x F.
  const Lanes i1 = squared_norm(f), scale = (-2.0 / 3 * j.log()).exp(), a = c10 * scale;
  Lanes energy = a * i1 - 3 * c10;
  Lanes along_f = 2 * a, along_h = volumetric.stress - 2.0 / 3 * a * i1 / j;
  LaneMatrix stress;
  if (c01 > 0) {
    const Lanes i2 = squared_norm(h), b = c01 * scale * scale;
    along_f += 2 * b * i1;
    along_h -= 4.0 / 3 * b * i2 / j;
    energy += b * i2 - 3 * c01;
    const LaneMatrix third = times_own_square(f);  // (cof F) x F = I1 F - F F^T F
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k)
        stress[i][k] = along_f * f[i][k] + along_h * h[i][k] - 2 * b * third[i][k];
  } else {
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k) stress[i][k] = along_f * f[i][k] + along_h * h[i][k];
  }
  result.energy = volume * volumetric.energy + (points.weights * energy).sum();
  for (auto& row : stress)
    for (Lanes& entry : row) entry *= points.weights;
  for (std::size_t n = 0; n < 10; ++n) {
    const auto& g = points.gradients[n];
    for (std::size_t i = 0; i < 3; ++i)
      result.force(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(n)) =
          (stress[i][0] * g[0] + stress[i][1] * g[1] + stress[i][2] * g[2]).sum();
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
