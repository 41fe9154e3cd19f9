// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/curvature.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "file_testing.h"
#include "mesh_corpus.h"
#include "palpate/core/error.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

TEST(Curvature, OfASphereIsOneOverTheRadius) {
  const double radius = 30.1;
  const VertexCurvature curvature = vertex_curvature(test::icosphere(4, radius));
  // The twelve vertices with five neighbours are off by more than the others.
  EXPECT_LT((curvature.mean.array() * radius - 1).abs().maxCoeff(), 0.02);
  EXPECT_LT((curvature.gaussian.array() * radius * radius - 1).abs().maxCoeff(), 0.04);
}

TEST(Curvature, OfATorusIsThatOfItsCirclesAndConverges) {
  const double radius = 30.1;
  const double tube = 8.3;
  const auto largest_errors = [&](int across) {
    const VertexCurvature curvature =
        vertex_curvature(test::torus(4 * across, across, radius, tube));
    Eigen::Array2d largest = Eigen::Array2d::Zero();
    for (int i = 0; i < curvature.mean.size(); ++i) {
      const double v = 2 * std::numbers::pi * (i % across) / across;
      const double along = std::cos(v) / (radius + tube * std::cos(v));  // the curvature there
      const Eigen::Array2d error(tube * (curvature.mean[i] - (along + 1 / tube) / 2),
                                 tube * tube * (curvature.gaussian[i] - along / tube));
      largest = largest.max(error.abs());
    }
    return largest;
  };
  const Eigen::Array2d coarse = largest_errors(40);
  const Eigen::Array2d fine = largest_errors(80);
  EXPECT_TRUE((fine < 0.003).all()) << fine;
  EXPECT_TRUE((coarse / fine > 3.5).all()) << coarse / fine;  // the square of the spacing: 4
}

TEST(Curvature, OfAWavySurfaceConvergesWhateverItsDiagonals) {
  const auto largest_errors = [](double spacing) {
    const int count = static_cast<int>(std::lround(20 / spacing));
    const TriangleMesh mesh = test::height_field(count, count, spacing, [](double x, double y) {
      return 2 * std::sin(x / 3) * std::cos(y / 4);
    });
    const VertexCurvature curvature = vertex_curvature(mesh);
    Eigen::Array2d largest = Eigen::Array2d::Zero();
    for (Eigen::Index i = 0; i < curvature.mean.size(); ++i) {
      const double x = mesh.vertices(0, i);
      const double y = mesh.vertices(1, i);
      if (std::abs(x - 10) > 8.9 || std::abs(y - 10) > 8.9) continue;  // normals at the border
      const double z_x = 2.0 / 3 * std::cos(x / 3) * std::cos(y / 4);
      const double z_y = -2.0 / 4 * std::sin(x / 3) * std::sin(y / 4);
      const double z_xx = -mesh.vertices(2, i) / 9;
      const double z_yy = -mesh.vertices(2, i) / 16;
      const double z_xy = -2.0 / 12 * std::cos(x / 3) * std::sin(y / 4);
      const double w = 1 + z_x * z_x + z_y * z_y;
      const double mean =
          -((1 + z_y * z_y) * z_xx - 2 * z_x * z_y * z_xy + (1 + z_x * z_x) * z_yy) /
          (2 * std::pow(w, 1.5));
      const double gaussian = (z_xx * z_yy - z_xy * z_xy) / (w * w);
      largest = largest.max(
          Eigen::Array2d(curvature.mean[i] - mean, curvature.gaussian[i] - gaussian).abs());
    }
    return largest;
  };
  const Eigen::Array2d coarse = largest_errors(0.5);
  const Eigen::Array2d fine = largest_errors(0.25);
  EXPECT_LT(fine[0], 0.0012);                                 // of 0.17 at most
  EXPECT_LT(fine[1], 0.0004);                                 // of 0.03 at most
  EXPECT_TRUE((coarse / fine > 3.5).all()) << coarse / fine;  // the square of the spacing: 4
}

TEST(Curvature, OfACylinderIsHalfOfItsCircle) {
  const double radius = 20.3;
  const TriangleMesh mesh = test::height_field(40, 10, 0.5, [&](double x, double) {
    return std::sqrt(radius * radius - (x - 10) * (x - 10));
  });
  const VertexCurvature curvature = vertex_curvature(mesh);
  for (int row = 1; row < 10; ++row) {
    for (int col = 10; col <= 30; ++col) {
      EXPECT_NEAR(curvature.mean[row * 41 + col] * radius, 0.5, 0.03);
      EXPECT_NEAR(curvature.gaussian[row * 41 + col] * radius * radius, 0, 1e-9);
    }
  }
}

TEST(Curvature, OfASaddleAndOfADentAreNegative) {
  const int centre = 10 * 21 + 10;
  const auto field = [](double a, double b) {
    return vertex_curvature(test::height_field(20, 20, 0.1, [&](double x, double y) {
      return (a * (x - 1) * (x - 1) + b * (y - 1) * (y - 1)) / 2;
    }));
  };
  const VertexCurvature saddle = field(0.05, -0.05);
  EXPECT_NEAR(saddle.mean[centre], 0, 1e-12);
  EXPECT_LT(saddle.gaussian[centre], -0.5 * 0.05 * 0.05);
  EXPECT_NEAR(field(0.05, 0.05).mean[centre], -0.05, 0.001);
  EXPECT_NEAR(field(-0.05, -0.05).mean[centre], 0.05, 0.001);
}

TEST(Curvature, IsUnknownAtTheBorderAndNowhereElse) {
  const VertexCurvature curvature = vertex_curvature(test::flat_sheet(7, 4, 1.5));
  for (int row = 0; row <= 4; ++row) {
    for (int col = 0; col <= 7; ++col) {
      const bool border = row == 0 || row == 4 || col == 0 || col == 7;
      const int i = row * 8 + col;
      EXPECT_EQ(std::isnan(curvature.mean[i]), border);
      EXPECT_EQ(std::isnan(curvature.gaussian[i]), border);
      if (border) continue;
      EXPECT_NEAR(curvature.mean[i], 0, 1e-14);
      EXPECT_NEAR(curvature.gaussian[i], 0, 1e-14);
    }
  }
}

TEST(Curvature, IsUnknownAtATriangleWithoutAreaAndALonelyVertex) {
  TriangleMesh mesh = test::icosphere(2, 10);
  const Eigen::Vector3i flat = mesh.triangles.col(5);
  mesh.vertices.col(flat[1]) = mesh.vertices.col(flat[0]);
  mesh.vertices.conservativeResize(3, mesh.vertices.cols() + 1);
  mesh.vertices.rightCols<1>().setOnes();
  const VertexCurvature curvature = vertex_curvature(mesh);
  for (const int vertex : flat) {
    EXPECT_TRUE(std::isnan(curvature.mean[vertex]));
    EXPECT_TRUE(std::isnan(curvature.gaussian[vertex]));
  }
  EXPECT_TRUE(std::isnan(curvature.mean[mesh.vertices.cols() - 1]));
  EXPECT_TRUE(std::isnan(curvature.gaussian[mesh.vertices.cols() - 1]));
  // The two triangles at the edge that vanished have four vertices.
  EXPECT_EQ(curvature.mean.array().isNaN().count(), 4 + 1);
  EXPECT_EQ(curvature.gaussian.array().isNaN().count(), 4 + 1);
}

TEST(Curvature, FollowsAMotionAndTheUnitOfLength) {
  const TriangleMesh mesh = test::torus(60, 20, 30.1, 8.3);
  const VertexCurvature curvature = vertex_curvature(mesh);
  const VertexCurvature moved = vertex_curvature(
      test::moved(mesh, Eigen::Translation3d(100.1, -70.3, 35.7) *
                            Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.48, 0.6, 0.64))));
  EXPECT_LT((moved.mean - curvature.mean).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((moved.gaussian - curvature.gaussian).cwiseAbs().maxCoeff(), 1e-12);
  for (const double scale : {0x1p-20, 0x1p20}) {
    const VertexCurvature scaled = vertex_curvature(test::scaled(mesh, scale));
    EXPECT_EQ(scaled.mean * scale, curvature.mean);
    EXPECT_EQ(scaled.gaussian * (scale * scale), curvature.gaussian);
  }
}

TEST(Curvature, RefusesAVertexThatIsNotFinite) {
  TriangleMesh mesh = test::icosphere(1, 10);
  mesh.vertices(1, 7) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROWS_MESSAGE((void)vertex_curvature(mesh), InvalidInput, "vertex 7");
}

}  // namespace
}  // namespace palpate::geometry
