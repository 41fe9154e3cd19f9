// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "clouds/shape_models.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <limits>

namespace palpate::geometry {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// Points, or directions, determine a shape if they are apart by more than this fraction of their
/// extent: far above rounding, far below the resolution of any instrument.
constexpr double kApart = 1e-9;

/// Least squares by Gauss and Newton. `equations(model, A, b)` adds up the normal equations A x = b
/// and returns the sum of squares; they are solved as such because the points, in about [-1, 1],
/// are many and the unknowns few. `moved(model, x)` is the model after a step. A step that is not
/// better is halved.
template <int Unknowns, typename Model, typename Equations, typename Moved>
std::optional<Model> gauss_newton(Model model, const Equations& equations, const Moved& moved) {
  using Matrix = Eigen::Matrix<double, Unknowns, Unknowns>;
  using Vector = Eigen::Matrix<double, Unknowns, 1>;
  constexpr int kMostSteps = 50, kMostHalvings = 20;
  constexpr double kSmallStep = 1e-14;
  // Shapes that the points hardly determine (a plane is a sphere of any large radius) would let
  // steps run away.
  constexpr double kSingular = 1e-13;
  Matrix A, next_A;
  Vector b, next_b;
  double squares = equations(model, A, b);
  for (int step = 0; step < kMostSteps; ++step) {
    const Eigen::LDLT<Matrix> factors(A);
    if (!(factors.rcond() > kSingular)) return std::nullopt;
    Vector x = factors.solve(b);
    Model next = moved(model, x);
    double next_squares = equations(next, next_A, next_b);
    for (int halving = 0; !(next_squares <= squares) && halving < kMostHalvings; ++halving) {
      x /= 2;
      next = moved(model, x);
      next_squares = equations(next, next_A, next_b);
    }
    if (!(next_squares <= squares)) break;  // the minimum, to rounding
    model = next;
    A = next_A;
    b = next_b;
    squares = next_squares;
    if (x.cwiseAbs().maxCoeff() < kSmallStep) break;
  }
  return model;
}

/// Adds the equation of a point with the residual r, whose derivatives are the row J.
template <typename Matrix, typename Vector>
void add_equation(const Vector& J, double r, Matrix& A, Vector& b) {
  A.noalias() += J * J.transpose();
  b.noalias() -= r * J;
}

}  // namespace

std::optional<PlaneModel> plane_through(std::span<const Vector3d, 3> points) {
  const Vector3d a = points[1] - points[0], b = points[2] - points[0];
  const Vector3d normal = a.cross(b);
  if (!(normal.norm() > kApart * a.norm() * b.norm())) return std::nullopt;
  return PlaneModel{.point = points[0], .normal = normal.normalized()};
}

std::optional<SphereModel> sphere_through(std::span<const Vector3d, 4> points) {
  // The centre, from the first point, is as far from it as from the others: 2 d_i . c = |d_i|^2.
  Matrix3d rows;
  Vector3d squares;
  for (int i = 0; i < 3; ++i) {
    const Vector3d d = points[static_cast<std::size_t>(i) + 1] - points[0];
    rows.row(i) = 2 * d.transpose();
    squares[i] = d.squaredNorm();
  }
  const double volume = std::abs(rows.determinant());
  if (!(volume > kApart * rows.row(0).norm() * rows.row(1).norm() * rows.row(2).norm()))
    return std::nullopt;
  const Vector3d centre = rows.partialPivLu().solve(squares);
  return SphereModel{.centre = points[0] + centre, .radius = centre.norm()};
}

std::optional<CylinderModel> cylinder_through(std::span<const Vector3d, 2> points,
                                              std::span<const Vector3d, 2> normals) {
  const Vector3d cross = normals[0].cross(normals[1]);
  if (!(cross.norm() > kApart)) return std::nullopt;
  const Vector3d axis = cross.normalized();
  // The intersection of the lines along the normals, seen along the axis: p0 + s n0 = p1 + t n1.
  const Vector3d between = points[1] - points[0];
  const double s = between.cross(normals[1]).dot(cross) / cross.squaredNorm();
  const double t = between.cross(normals[0]).dot(cross) / cross.squaredNorm();
  const double first = std::abs(s) * normals[0].norm(), second = std::abs(t) * normals[1].norm();
  return CylinderModel{
      .point = points[0] + s * normals[0], .axis = axis, .radius = (first + second) / 2};
}

std::optional<PlaneModel> fitted(const PlaneModel& /*first*/, const Matrix3Xd& points) {
  if (points.cols() < 3) return std::nullopt;
  const Vector3d mean = points.rowwise().mean();
  const Matrix3Xd offsets = points.colwise() - mean;
  const Matrix3d scatter = offsets * offsets.transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(scatter);
  if (!(axes.eigenvalues()[1] > kApart * kApart * axes.eigenvalues()[2])) return std::nullopt;
  return PlaneModel{.point = mean, .normal = axes.eigenvectors().col(0)};
}

std::optional<SphereModel> fitted(const SphereModel& first, const Matrix3Xd& points) {
  using Vector = Eigen::Vector4d;
  const auto equations = [&](const SphereModel& sphere, Eigen::Matrix4d& A, Vector& b) {
    A.setZero();
    b.setZero();
    double squares = 0;
    for (const auto& p : points.colwise()) {
      const Vector3d d = p - sphere.centre;
      const double length = d.norm();
      if (!(length > 0)) continue;  // at the centre there is no direction
      Vector J;
      J << -d / length, -1;
      const double r = length - sphere.radius;
      add_equation(J, r, A, b);
      squares += r * r;
    }
    return squares;
  };
  const auto moved = [](const SphereModel& sphere, const Vector& x) {
    return SphereModel{.centre = sphere.centre + x.head<3>(), .radius = sphere.radius + x[3]};
  };
  return gauss_newton<4>(first, equations, moved);
}

std::optional<CylinderModel> fitted(const CylinderModel& first, const Matrix3Xd& points) {
  using Vector = Eigen::Matrix<double, 5, 1>;
  if (points.cols() < 5) return std::nullopt;
  // The point of the axis next to the centroid, so that turning the axis hardly moves it.
  const auto centred = [mean = Vector3d(points.rowwise().mean())](CylinderModel cylinder) {
    cylinder.point += cylinder.axis * cylinder.axis.dot(mean - cylinder.point);
    return cylinder;
  };
  // Unknowns: shift and turn along two directions across the axis, and the radius.
  const auto equations = [&](const CylinderModel& cylinder, Eigen::Matrix<double, 5, 5>& A,
                             Vector& b) {
    const Vector3d u = cylinder.axis.unitOrthogonal(), v = cylinder.axis.cross(u);
    A.setZero();
    b.setZero();
    double squares = 0;
    for (const auto& p : points.colwise()) {
      const Vector3d d = p - cylinder.point;
      const double along = cylinder.axis.dot(d);
      const Vector3d across = d - along * cylinder.axis;
      const double length = across.norm();
      if (!(length > 0)) continue;
      const double eu = across.dot(u) / length, ev = across.dot(v) / length;
      Vector J;
      J << -eu, -ev, -along * eu, -along * ev, -1;
      const double r = length - cylinder.radius;
      add_equation(J, r, A, b);
      squares += r * r;
    }
    return squares;
  };
  const auto moved = [&](const CylinderModel& cylinder, const Vector& x) {
    const Vector3d u = cylinder.axis.unitOrthogonal(), v = cylinder.axis.cross(u);
    return centred({.point = cylinder.point + x[0] * u + x[1] * v,
                    .axis = (cylinder.axis + x[2] * u + x[3] * v).normalized(),
                    .radius = cylinder.radius + x[4]});
  };
  return gauss_newton<5>(centred(first), equations, moved);
}

}  // namespace palpate::geometry
