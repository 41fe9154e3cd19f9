// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <utility>

#include "mesh_corpus.h"
#include "palpate/core/error.h"
#include "palpate/geometry/decimation.h"
#include "palpate/geometry/mesh_topology.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/geometry/texture.h"
#include "refusal.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kFullTurn = 2 * std::numbers::pi;
constexpr int kTorusAround = 84, kTorusAcross = 42;
constexpr double kTorusRadius = 40, kTorusTube = 14;  // mm

/// The place on the torus that the texture shows at u, v. The picture is drawn unevenly along u, as
/// a camera sees a surface, so that long edges would displace it.
Vector3d shown_at(const Vector2d& uv) {
  const double theta = kFullTurn * (uv.x() + 0.1 * std::sin(kFullTurn * uv.x()));
  const double phi = kFullTurn * uv.y();
  const double r = kTorusRadius + kTorusTube * std::cos(phi);
  return {r * std::cos(theta), r * std::sin(theta), kTorusTube * std::sin(phi)};
}

struct Textured {
  TriangleMesh mesh;
  CornerTexture texture;
};

/// A torus whose texture is cut along one circle of each kind: vertices have one, two or four
/// places in the picture. A second picture begins half-way around.
Textured textured_torus() {
  Textured torus;
  torus.mesh.vertices.resize(3, kTorusAround * kTorusAcross);
  torus.mesh.triangles.resize(3, 2 * kTorusAround * kTorusAcross);
  torus.texture.coordinates.resize(6, torus.mesh.triangles.cols());
  torus.texture.number.resize(torus.mesh.triangles.cols());
  const auto uv = [](int i, int j) {
    return Vector2d(static_cast<double>(i) / kTorusAround, static_cast<double>(j) / kTorusAcross);
  };
  const auto vertex = [](int i, int j) {
    return i % kTorusAround * kTorusAcross + j % kTorusAcross;
  };
  Eigen::Index t = 0;
  for (int i = 0; i < kTorusAround; ++i) {
    for (int j = 0; j < kTorusAcross; ++j) {
      torus.mesh.vertices.col(vertex(i, j)) = shown_at(uv(i, j));
      for (const bool second : {false, true}) {
        const std::array<Eigen::Vector2i, 3> corners = {Eigen::Vector2i(i, j),
                                                        Eigen::Vector2i(i + 1, second ? j + 1 : j),
                                                        Eigen::Vector2i(second ? i : i + 1, j + 1)};
        for (int k = 0; k < 3; ++k) {
          const auto& at = corners[static_cast<std::size_t>(k)];
          torus.mesh.triangles(k, t) = vertex(at.x(), at.y());
          torus.texture.coordinates.block<2, 1>(2 * k, t) = uv(at.x(), at.y());
        }
        torus.texture.number[t++] = i < kTorusAround / 2 ? 0 : 1;
      }
    }
  }
  return torus;
}

Vector2d texture_at(const CornerTexture& texture, const SurfacePoint& place) {
  Vector2d uv = Vector2d::Zero();
  for (int k = 0; k < 3; ++k)
    uv += place.barycentric[k] * texture.coordinates.block<2, 1>(2 * k, place.triangle);
  return uv;
}

TEST(TexturedDecimation, ShowsThePictureWhereItWasAndOpensNoSeam) {
  const Textured torus = textured_torus();
  // Share of the triangles that may be left: an uneven picture bends long triangles away.
  for (const auto& [tolerance, most] : {std::pair(0.4, 0.8), std::pair(1.6, 0.4)}) {
    const TexturedDecimation result = decimate(torus.mesh, torus.texture, {.tolerance = tolerance});
    const TriangleMesh& mesh = result.decimation.mesh;
    const CornerTexture& texture = result.texture;
    ASSERT_EQ(texture.coordinates.cols(), mesh.triangles.cols());
    EXPECT_LT(mesh.triangles.cols(), most * static_cast<double>(torus.mesh.triangles.cols()));
    EXPECT_EQ(test::border_edges(mesh), 0);
    EXPECT_EQ(euler_characteristic(mesh), 0);
    for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v)
      EXPECT_EQ(mesh.vertices.col(v),
                torus.mesh.vertices.col(result.decimation.source[static_cast<std::size_t>(v)]));
    std::mt19937 random(3);
    std::uniform_real_distribution<double> any(0, 1);
    double worst = 0;
    for (int t = 0; t < mesh.triangles.cols(); ++t) {
      for (int i = 0; i < 10; ++i) {
        Vector3d at{any(random), any(random), any(random)};
        at /= at.sum();
        const SurfacePoint place{.triangle = t, .barycentric = at};
        worst =
            std::max(worst, (shown_at(texture_at(texture, place)) - position(mesh, place)).norm());
      }
    }
    // Displaced along the surface and off it, and a little more between the places that are
    // examined.
    EXPECT_LT(worst, 1.5 * tolerance);
  }
}

TEST(TexturedDecimation, OfAPictureAsACameraTakesItCostsFewTriangles) {
  // Seen from z, with a picture for each half: charts as photogrammetry makes them.
  const TriangleMesh mesh = test::bumpy(6000);
  CornerTexture texture;
  texture.coordinates.resize(6, mesh.triangles.cols());
  texture.number.resize(mesh.triangles.cols());
  const double middle = mesh.vertices.row(0).mean();
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Eigen::Matrix3d corners = mesh.vertices(Eigen::all, mesh.triangles.col(t));
    texture.number[t] = corners.row(0).mean() < middle ? 0 : 1;
    for (int k = 0; k < 3; ++k)
      texture.coordinates.block<2, 1>(2 * k, t) = corners.col(k).head<2>() / corners(2, k);
  }
  constexpr double kTolerance = 2;
  const auto plain = decimate(mesh, {.tolerance = kTolerance}).mesh.triangles.cols();
  const TexturedDecimation textured = decimate(mesh, texture, {.tolerance = kTolerance});
  EXPECT_LT(plain, mesh.triangles.cols() / 2);
  EXPECT_LT(static_cast<double>(textured.decimation.mesh.triangles.cols()),
            1.3 * static_cast<double>(plain));
}

TEST(TexturedDecimation, KeepsEachPictureOnItsSideOfTheSeam) {
  const Textured torus = textured_torus();
  constexpr double kTolerance = 0.3;
  const TexturedDecimation result = decimate(torus.mesh, torus.texture, {.tolerance = kTolerance});
  const TriangleMesh& mesh = result.decimation.mesh;
  int first = 0;
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    const int number = result.texture.number[t];
    first += number == 0 ? 1 : 0;
    const Vector3d centre = mesh.vertices(Eigen::all, mesh.triangles.col(t)).rowwise().mean();
    // The half-planes meet where y = 0.
    EXPECT_GT(number == 0 ? centre.y() : -centre.y(), -kTolerance) << t;
  }
  EXPECT_GT(first, mesh.triangles.cols() / 4);
  EXPECT_LT(first, 3 * mesh.triangles.cols() / 4);
}

TEST(TexturedDecimation, ToACountOpensNoSeamAndKeepsPlacesOfVertices) {
  const Textured torus = textured_torus();
  const TexturedDecimation result = decimate(torus.mesh, torus.texture, {.max_triangles = 1500});
  const TriangleMesh& mesh = result.decimation.mesh;
  EXPECT_LT(mesh.triangles.cols(), 2000);
  EXPECT_EQ(test::border_edges(mesh), 0);
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const SurfacePoint corner = corner_point(t, k);
      EXPECT_LT((shown_at(texture_at(result.texture, corner)) - position(mesh, corner)).norm(),
                1e-9);
    }
  }
}

TEST(TexturedDecimation, APartWithoutATextureIsDecimatedToo) {
  Textured torus = textured_torus();
  const Eigen::Index half = torus.mesh.triangles.cols() / 2;
  torus.texture.coordinates.rightCols(half).setConstant(std::numeric_limits<double>::quiet_NaN());
  torus.texture.number.resize(0);
  const TexturedDecimation result = decimate(torus.mesh, torus.texture, {.tolerance = 0.3});
  const TriangleMesh& mesh = result.decimation.mesh;
  EXPECT_LT(mesh.triangles.cols(), 0.65 * static_cast<double>(torus.mesh.triangles.cols()));
  EXPECT_EQ(test::border_edges(mesh), 0);
  EXPECT_EQ(result.texture.number.size(), 0);
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    const Vector3d centre = mesh.vertices(Eigen::all, mesh.triangles.col(t)).rowwise().mean();
    if (std::abs(centre.y()) < 1) continue;
    EXPECT_EQ(result.texture.coordinates.col(t).allFinite(), centre.y() > 0) << t;
    EXPECT_EQ(result.texture.coordinates.col(t).array().isNaN().all(), centre.y() < 0) << t;
  }
}

TEST(TexturedDecimation, RefusesATextureOfAnotherMesh) {
  Textured torus = textured_torus();
  torus.texture.coordinates.conservativeResize(6, 5);
  EXPECT_NE(refusal([&] {
              return decimate(torus.mesh, torus.texture, {.tolerance = 1});
            }).find("the texture has 5 triangles"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate::geometry
