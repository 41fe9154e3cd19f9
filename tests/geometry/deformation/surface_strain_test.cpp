// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/surface_strain.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "refusal.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using test::flat_sheet;
using test::icosphere;

Matrix3Xd mapped(const TriangleMesh& mesh, const std::function<Vector3d(const Vector3d&)>& map) {
  Matrix3Xd vertices(3, mesh.vertices.cols());
  for (Eigen::Index v = 0; v < vertices.cols(); ++v) vertices.col(v) = map(mesh.vertices.col(v));
  return vertices;
}

void expect_stretches(const SurfaceStrain& strain, double largest, double smallest,
                      double tolerance) {
  EXPECT_LE((strain.largest.array() - largest).abs().maxCoeff(), tolerance);
  EXPECT_LE((strain.smallest.array() - smallest).abs().maxCoeff(), tolerance);
  EXPECT_LE((strain.area.array() - largest * smallest).abs().maxCoeff(), 2 * tolerance);
}

const Eigen::Isometry3d kMotion =
    Eigen::Translation3d(50, -20, 700) * Eigen::AngleAxisd(0.8, Vector3d(1, 2, -1).normalized());

// Side of the cells of the sheets [mm].
constexpr double kCell = 2;

TEST(SurfaceStrain, IsOneUnderARigidMotion) {
  const TriangleMesh ball = icosphere(3, 40);
  const Matrix3Xd moved = kMotion * ball.vertices;
  expect_stretches(surface_strain(ball, moved), 1, 1, 1e-12);
  expect_stretches(surface_strain(ball, moved, 10), 1, 1, 1e-12);
}

TEST(SurfaceStrain, IsThatOfALinearMapOfAPlane) {
  const TriangleMesh sheet = flat_sheet(12, 9, kCell);
  const double shear = 0.3;
  const auto map = [&](const Vector3d& at) {
    return Vector3d(kMotion * Vector3d(1.2 * (at.x() + shear * at.y()), 0.9 * at.y(), at.z()));
  };
  Eigen::Matrix2d linear;
  linear << 1.2, 1.2 * shear, 0, 0.9;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> squares(linear * linear.transpose());
  Vector3d along = Vector3d::Zero();
  along.head<2>() = squares.eigenvectors().col(1);
  along = kMotion.linear() * along;
  for (const double radius : {0.0, 5.0}) {
    const SurfaceStrain strain = surface_strain(sheet, mapped(sheet, map), radius);
    expect_stretches(strain, std::sqrt(squares.eigenvalues()(1)),
                     std::sqrt(squares.eigenvalues()(0)), 1e-9);
    EXPECT_GT((along.transpose() * strain.direction).cwiseAbs().minCoeff(), 1 - 1e-9);
  }
}

TEST(SurfaceStrain, IsTheFactorOfAnInflation) {
  const TriangleMesh ball = icosphere(3, 40);
  expect_stretches(surface_strain(ball, 1.3 * ball.vertices, 8), 1.3, 1.3, 1e-9);
}

// A chord of the length h on a circle of radius R is shorter than its arc by h^2 / 24 R^2.
TEST(SurfaceStrain, OfABentSheetIsOneUpToTheSquareOfTheAngles) {
  const TriangleMesh sheet = flat_sheet(30, 10, kCell);
  const double bent = 40;
  const auto map = [&](const Vector3d& at) {
    return Vector3d(bent * std::sin(at.x() / bent), at.y(), bent * std::cos(at.x() / bent));
  };
  const double chord = std::sqrt(2) * kCell;  // of a diagonal
  expect_stretches(surface_strain(sheet, mapped(sheet, map)), 1, 1,
                   2 * chord * chord / (24 * bent * bent));
}

// Twisting a tube by `twist` per mm shears its surface by r twist.
TEST(SurfaceStrain, IsTheShearOfATwistedTube) {
  constexpr int kAround = 90, kAlong = 30;
  const double radius = 20, twist = 0.02;
  TriangleMesh tube = flat_sheet(kAround, kAlong, 2 * std::numbers::pi * radius / kAround);
  const auto roll = [&](double turn) {
    return [turn, radius](const Vector3d& at) {
      const double angle = at.x() / radius + turn * at.y();
      return Vector3d(radius * std::cos(angle), radius * std::sin(angle), at.y());
    };
  };
  const Matrix3Xd twisted = mapped(tube, roll(twist));
  tube.vertices = mapped(tube, roll(0));
  const double shear = radius * twist, root = std::sqrt(1 + shear * shear / 4);
  expect_stretches(surface_strain(tube, twisted), root + shear / 2, root - shear / 2, 3e-3);
}

TEST(SurfaceStrain, DoesNotDependOnTheUnitNorOnTheOrderOfTriangles) {
  TriangleMesh sheet = flat_sheet(12, 9, kCell);
  const Matrix3Xd moved = mapped(sheet, [](const Vector3d& at) {
    return Vector3d(at.x() + 0.02 * at.x() * at.x(), at.y(), std::sin(0.2 * at.x()));
  });
  const SurfaceStrain strain = surface_strain(sheet, moved, 3);
  sheet.triangles.rowwise().reverseInPlace();
  const TriangleMesh metres{.vertices = sheet.vertices / 1000, .triangles = sheet.triangles};
  const SurfaceStrain same = surface_strain(metres, moved / 1000, 3e-3);
  EXPECT_LT((same.largest - strain.largest).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((same.smallest - strain.smallest).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(SurfaceStrain, OfALargerRadiusHasLessNoise) {
  const TriangleMesh sheet = flat_sheet(40, 40, kCell);
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 0.05);
  const Matrix3Xd moved = mapped(sheet, [&](const Vector3d& at) {
    const double x = 1.1 * at.x() + noise(random), y = at.y() + noise(random);
    return Vector3d(x, y, at.z());
  });
  const auto error = [&](double radius) {
    const Eigen::VectorXd largest = surface_strain(sheet, moved, radius).largest;
    return std::sqrt((largest.array() - 1.1).square().mean());
  };
  EXPECT_LT(error(0), 0.03);
  EXPECT_LT(error(8), error(0) / 4);
}

TEST(SurfaceStrain, IsUnknownWhereNeighboursLieOnALine) {
  TriangleMesh sheet = flat_sheet(3, 3, kCell);
  sheet.vertices.conservativeResize(Eigen::NoChange, sheet.vertices.cols() + 1);
  sheet.vertices.rightCols<1>() << 9, 9, 9;  // of no triangle
  const SurfaceStrain strain = surface_strain(sheet, sheet.vertices);
  EXPECT_TRUE(strain.largest.head(16).allFinite());
  EXPECT_TRUE(std::isnan(strain.largest[16]));
  EXPECT_TRUE(std::isnan(strain.direction(0, 16)));
}

TEST(SurfaceStrain, RefusesOtherSurfaces) {
  const TriangleMesh sheet = flat_sheet(3, 3, kCell);
  EXPECT_THAT(refusal([&] { return surface_strain(sheet, sheet.vertices.leftCols(4)); }),
              ::testing::HasSubstr("vertices has 4 columns; the reference has 16 vertices"));
  EXPECT_THAT(refusal([&] { return surface_strain(sheet, sheet.vertices, -1); }),
              ::testing::HasSubstr("radius is -1"));
  Matrix3Xd broken = sheet.vertices;
  broken(1, 2) = std::nan("");
  EXPECT_THAT(refusal([&] { return surface_strain(sheet, broken); }),
              ::testing::HasSubstr("not finite"));
}

}  // namespace
}  // namespace palpate::geometry
