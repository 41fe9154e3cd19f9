// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/deformed_shape.h"

#include <gtest/gtest.h>

#include "following_surface.h"
#include "not_finite.h"
#include "palpate/haptics/rotation.h"
#include "refusal.h"
#include "sheet_model.h"

namespace palpate::haptics {
namespace {

constexpr int kMiddle = 60;  // vertex in the middle of `flat_surface`, at the corner of triangles

/// A place at the middle vertex, and beside it.
geometry::SurfacePoint place(const geometry::TriangleMesh& mesh, double beside = 0) {
  const geometry::SurfaceQuery query(mesh);
  return query.closest_point(mesh.vertices.col(kMiddle) + Eigen::Vector3d(beside, 0, 0)).at;
}

TEST(DrawnShape, MovesTheContactByTheDisplacementAndNothingFarAway) {
  const geometry::TriangleMesh mesh = flat_surface(50, 10);
  const Eigen::Vector3d displacement(1, 2, 6);
  const DrawnShapeOptions options{.tip = 3, .reach = 3};
  const Eigen::Matrix3Xd shape = drawn_shape(mesh, place(mesh), displacement, options);
  const double radius = 3 + 3 * displacement.norm();
  for (Eigen::Index v = 0; v < shape.cols(); ++v) {
    const double s = (mesh.vertices.col(v) - mesh.vertices.col(kMiddle)).norm() / radius;
    const double part = s < 1 ? (1 - s * s) * (1 - s * s) : 0;
    // Distances on a flat surface are straight, to the accuracy of fast marching.
    EXPECT_LT((shape.col(v) - mesh.vertices.col(v) - part * displacement).norm(), 0.05) << v;
  }
  EXPECT_LT((shape.col(kMiddle) - mesh.vertices.col(kMiddle) - displacement).norm(), 1e-9);
}

TEST(DrawnShape, MovesWithTheWorld) {
  geometry::TriangleMesh mesh = flat_surface(20, 10);
  const Eigen::Vector3d displacement(0.5, 0, 3);
  const Eigen::Matrix3Xd shape = drawn_shape(mesh, place(mesh, 0.7), displacement);
  const geometry::SurfacePoint at = place(mesh, 0.7);
  const Eigen::Matrix3d rotation = rotation_exp({0.3, -0.4, 0.5});
  mesh.vertices = (rotation * mesh.vertices).eval();
  const Eigen::Matrix3Xd turned = drawn_shape(mesh, at, rotation * displacement);
  EXPECT_LT((turned - rotation * shape).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(DrawnShape, IsContinuousInContactAndDisplacement) {
  const geometry::TriangleMesh mesh = flat_surface(20, 10);
  Eigen::Matrix3Xd last;
  for (int i = 0; i <= 400; ++i) {
    const double at = 0.01 * i;  // over an edge
    const Eigen::Matrix3Xd shape =
        drawn_shape(mesh, place(mesh, at - 2), Eigen::Vector3d(0, 0, 0.01 * i));
    if (i > 0) {
      EXPECT_LT((shape - last).cwiseAbs().maxCoeff(), 0.05) << i;
    }
    last = shape;
  }
}

TEST(DrawnShape, IsTheSurfaceWithoutADisplacement) {
  const geometry::TriangleMesh mesh = flat_surface();
  EXPECT_EQ(drawn_shape(mesh, place(mesh), {0, 0, 0}), mesh.vertices);
  EXPECT_EQ(drawn_shape(mesh, place(mesh), {0, kNaN, 0}), mesh.vertices);
  EXPECT_NE(refusal([&] {
              return drawn_shape(mesh, place(mesh), {0, 0, 1}, {.reach = 0});
            }).find("DrawnShapeOptions::reach"),
            std::string::npos);
}

TEST(DrawnShape, RefusesAContactThatIsNotOnTheSurface) {
  const geometry::TriangleMesh mesh = flat_surface(20, 10);
  const std::string refused = refusal([&] {
    return drawn_shape(mesh, geometry::SurfacePoint{}, {0, 0, 1});
  });
  EXPECT_EQ(refused.find("drawn_shape(): contact: triangle -1"), 0) << refused;
}

TEST(MeasuredShape, HasTheContactAtTheToolAndIsContinuous) {
  const FollowingSheet sheet;
  const SurfaceResponse response = sheet.fit();
  const geometry::TriangleMesh& mesh = sheet.model.surface;
  const BlendedField field(sheet.model);
  Eigen::Matrix3Xd before;
  for (int i = 0; i < 400; ++i) {
    // Across triangles of the mesh and of contacts.
    const Eigen::Vector3d at(-28 + 0.14 * i, -20 + 0.1 * i, 700),
        displacement(0.002 * i, 1, 4 + 0.005 * i);
    const geometry::SurfacePoint contact = field.surface().closest_point(at).at;
    const Eigen::Matrix3Xd shape =
        measured_shape(mesh, response, field.weights(contact), contact, displacement);
    const Eigen::Vector3i corners = mesh.triangles.col(contact.triangle);
    const Eigen::Vector3d moved = shape(Eigen::all, corners) * contact.barycentric;
    EXPECT_LT((moved - at - displacement).norm(), 1e-9) << i;
    if (i > 0) {
      EXPECT_LT((shape - before).colwise().norm().maxCoeff(), 0.2) << i;
    }
    before = shape;
  }
}

TEST(MeasuredShape, IsADrawnDentWhereNothingWasRecorded) {
  const FollowingSheet sheet;
  SurfaceResponse response = sheet.fit();
  response.responses.setZero();
  response.dents.setZero();
  const BlendedField field(sheet.model);
  const geometry::TriangleMesh& mesh = sheet.model.surface;
  const geometry::SurfacePoint at = field.surface().closest_point({2.5, 5, 700}).at;  // a vertex
  EXPECT_LT((measured_shape(mesh, response, field.weights(at), at, {1, 0, 5}) -
             drawn_shape(mesh, at, {1, 0, 5}))
                .cwiseAbs()
                .maxCoeff(),
            1e-9);
  EXPECT_EQ(measured_shape(mesh, response, field.weights(at), at, {kNaN, 0, 5}), mesh.vertices);
}

// By brute force over all recorded shapes of the contact that weighs most.
TEST(NearestShape, IsTheRecordedShapeOfTheHeaviestContactWhoseTipWasNearest) {
  FollowingSheet sheet;
  sheet.model.response = sheet.fit();
  const BlendedField field(sheet.model);
  const geometry::GeodesicSurface surface(sheet.model.surface);
  for (const Eigen::Vector3d& place : {Eigen::Vector3d(-12, 5, 700), Eigen::Vector3d(20, -25, 700),
                                       Eigen::Vector3d(28, 30, 700)}) {
    for (const Eigen::Vector3d& displacement :
         {Eigen::Vector3d(0, 0, 5), Eigen::Vector3d(3, 0, 3), Eigen::Vector3d(-3, 3, 9)}) {
      const geometry::SurfacePoint at = field.surface().closest_point(place).at;
      const geometry::ContactWeights weights = field.weights(at);
      int heaviest = 0;
      for (int k = 1; k < weights.count; ++k)
        if (weights.weights[static_cast<std::size_t>(k)] >
            weights.weights[static_cast<std::size_t>(heaviest)])
          heaviest = k;
      const auto contact =
          static_cast<std::size_t>(weights.contacts[static_cast<std::size_t>(heaviest)]);
      const RecordedShape* nearest = nullptr;
      const auto distance = [&](const RecordedShape& shape) {
        return (sheet.model.contacts[contact].position + shape.displacement - place - displacement)
            .norm();
      };
      for (const RecordedShape& shape : sheet.shapes) {
        if (shape.contact != contact) continue;
        if (nearest == nullptr || distance(shape) < distance(*nearest)) nearest = &shape;
      }
      const Eigen::Matrix3Xd shown =
          nearest_shape(sheet.model, surface, field.surface(), weights, at, displacement);
      EXPECT_LT((shown - nearest->vertices).colwise().norm().mean(), 0.1);
    }
  }
}

TEST(NearestShape, IsADrawnDentWhereNothingWasRecorded) {
  FollowingSheet sheet;
  sheet.model.response = sheet.fit();
  const BlendedField field(sheet.model);
  const geometry::GeodesicSurface surface(sheet.model.surface);
  const geometry::SurfacePoint at =
      field.surface().closest_point(sheet.model.contacts[1].position).at;
  sheet.model.response->shape_contacts.resize(0);
  EXPECT_TRUE(
      nearest_shape(sheet.model, surface, field.surface(), field.weights(at), at, {0, 0, 4}) ==
      drawn_shape(surface, at, {0, 0, 4}, shape_options(sheet.model)));
}

TEST(DisplayedShape, FollowsTheRecordedShapesIfTheModelHasAny) {
  FollowingSheet sheet;
  const BlendedField field(sheet.model);
  const geometry::GeodesicSurface surface(sheet.model.surface);
  const Playback playback(sheet.model);
  LoopState state;
  EXPECT_EQ(displayed_shape(sheet.model, field, surface, state), sheet.model.surface.vertices);
  const Eigen::Vector3d place = sheet.model.contacts[1].position, displacement(0, 0, 6);
  for (int i = 0; i <= 10; ++i)
    static_cast<void>(playback.step(place + 0.1 * i * displacement, state));
  const Eigen::Matrix3Xd truth = true_shape(sheet.model.surface, place, displacement);
  const auto error = [&] {
    return (displayed_shape(sheet.model, field, surface, state) - truth).colwise().norm().mean();
  };
  const double drawn = error();
  sheet.model.response = sheet.fit();
  EXPECT_LT(error(), 0.2 * drawn);
  EXPECT_LT((displayed_shape(sheet.model, field, surface, state, ShapeRule::nearest) - truth)
                .colwise()
                .norm()
                .mean(),
            0.2 * drawn);
}

}  // namespace
}  // namespace palpate::haptics
