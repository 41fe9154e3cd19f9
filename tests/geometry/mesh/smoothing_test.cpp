// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/smoothing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "file_testing.h"
#include "mesh_corpus.h"
#include "not_finite.h"
#include "palpate/core/error.h"
#include "palpate/geometry/mesh_measures.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

/// A flat regular polygon about the origin, one triangle a side.
TriangleMesh polygon(int sides) {
  TriangleMesh mesh;
  mesh.vertices = Eigen::Matrix3Xd::Zero(3, sides + 1);
  mesh.triangles.resize(3, sides);
  for (int i = 0; i < sides; ++i) {
    const double angle = 2 * std::numbers::pi * i / sides;
    mesh.vertices.col(i) << std::cos(angle), std::sin(angle), 0;
    mesh.triangles.col(i) << sides, i, (i + 1) % sides;
  }
  return mesh;
}

TEST(Smoothing, TakesTheNoiseOffASphereAndKeepsItsVolume) {
  const double radius = 50.3;
  const TriangleMesh sphere = test::icosphere(4, radius);
  TriangleMesh noisy = sphere;
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.4);
  for (auto vertex : noisy.vertices.colwise()) vertex *= 1 + noise(random) / radius;
  const auto roughness = [&](const TriangleMesh& mesh) {
    return std::sqrt((mesh.vertices.colwise().norm().array() - radius).square().mean());
  };
  const TriangleMesh smoothed = smooth(noisy);
  EXPECT_GT(roughness(noisy), 0.35);
  EXPECT_LT(roughness(smoothed), roughness(noisy) / 2.5);
  EXPECT_NEAR(enclosed_volume(smoothed) / enclosed_volume(sphere), 1, 0.006);
}

TEST(Smoothing, MultipliesAWaveByTheTransferFunction) {
  // The corners of a polygon are one wave of its border, of frequency 1 - cos(2 pi / n).
  const SmoothingOptions options{.iterations = 7, .pass_band = 0.17};
  const double mu = 1 / (options.pass_band - 1 / kSmoothingStep);
  for (const int sides : {4, 5, 9, 40}) {
    const double frequency = 1 - std::cos(2 * std::numbers::pi / sides);
    const double factor =
        std::pow((1 - kSmoothingStep * frequency) * (1 - mu * frequency), options.iterations);
    const TriangleMesh mesh = polygon(sides);
    EXPECT_LT((smooth(mesh, options).vertices - factor * mesh.vertices).cwiseAbs().maxCoeff(),
              1e-13);
    EXPECT_EQ(factor > 1, frequency < options.pass_band);
  }
}

TEST(Smoothing, KeepsTheBorderWhereItIsIfAsked) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.4);
  const TriangleMesh mesh =
      test::height_field(20, 14, 1.3, [&](double, double) { return noise(random); });
  const TriangleMesh kept = smooth(mesh, {.keep_border = true});
  const TriangleMesh free = smooth(mesh);
  for (int row = 0; row <= 14; ++row) {
    for (int col = 0; col <= 20; ++col) {
      const bool border = row == 0 || row == 14 || col == 0 || col == 20;
      const int i = row * 21 + col;
      EXPECT_EQ(kept.vertices.col(i) == mesh.vertices.col(i), border);
      EXPECT_NE(free.vertices.col(i), mesh.vertices.col(i));
    }
  }
}

TEST(Smoothing, TheBorderDoesNotShrinkInwards) {
  // Drawn along itself only, a straight border stays straight.
  const TriangleMesh sheet = test::flat_sheet(30, 20, 1.3);
  const TriangleMesh smoothed = smooth(sheet);
  for (int col = 10; col <= 20; ++col) EXPECT_NEAR(smoothed.vertices(1, col), 0, 0.01);
  EXPECT_EQ(smoothed.vertices.row(2).cwiseAbs().maxCoeff(), 0);
  EXPECT_NEAR(surface_area(smoothed) / surface_area(sheet), 1, 0.005);
}

TEST(Smoothing, FollowsAMotionAndTheUnitOfLength) {
  const TriangleMesh mesh = test::bumpy(3000, 0.25);
  const Eigen::Isometry3d T = Eigen::Translation3d(100.1, -70.3, 35.7) *
                              Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.48, 0.6, 0.64));
  const TriangleMesh smoothed = smooth(mesh);
  const TriangleMesh moved = smooth(test::moved(mesh, T));
  EXPECT_LT((moved.vertices - T * smoothed.vertices).cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_EQ(moved.triangles, mesh.triangles);
  for (const double scale : {0x1p-20, 0x1p20})
    EXPECT_EQ(smooth(test::scaled(mesh, scale)).vertices, smoothed.vertices * scale);
}

TEST(Smoothing, NoIterationsAndALonelyVertexChangeNothing) {
  TriangleMesh mesh = test::icosphere(2, 10);
  mesh.vertices.conservativeResize(3, mesh.vertices.cols() + 1);
  mesh.vertices.rightCols<1>() << 1.1, 2.2, 3.3;
  EXPECT_EQ(smooth(mesh, {.iterations = 0}).vertices, mesh.vertices);
  EXPECT_EQ(smooth(mesh).vertices.rightCols<1>(), mesh.vertices.rightCols<1>());
}

TEST(Smoothing, RefusesBadOptionsAndAVertexThatIsNotFinite) {
  TriangleMesh mesh = test::icosphere(1, 10);
  const auto refuse = [&](const SmoothingOptions& options, const char* words) {
    EXPECT_THROWS_MESSAGE((void)smooth(mesh, options), InvalidInput, words);
  };
  refuse({.iterations = -1}, "iterations is -1");
  for (const double bad : {0.0, -0.5, 1.0, kNaN}) refuse({.pass_band = bad}, "pass_band");
  mesh.vertices(1, 7) = kNaN;
  refuse({}, "vertex 7");
}

}  // namespace
}  // namespace palpate::geometry
