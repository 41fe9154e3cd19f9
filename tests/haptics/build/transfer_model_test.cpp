// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/transfer_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hump_model.h"
#include "palpate/haptics/blended_field.h"
#include "palpate/haptics/contact_compliance.h"
#include "palpate/haptics/contact_strength.h"
#include "palpate/haptics/rounding.h"
#include "sheet_model.h"
#include "sphere_model.h"

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;

Eigen::Matrix3Xd corners(const geometry::TriangleMesh& square) {
  const Eigen::Index last = square.vertices.cols() - 1;
  Eigen::Matrix3Xd marks(3, 3);
  marks << square.vertices.col(0), square.vertices.col(10), square.vertices.col(last);
  return marks;
}

TEST(TransferModel, MovesWithTheSurface) {
  const Model model = uneven_model();
  const Eigen::Isometry3d motion = some_motion();
  const Model truth = moved(model, motion);
  const geometry::SurfaceMap map =
      geometry::map_surface(model.surface, truth.surface,
                            {.source = corners(model.surface), .target = corners(truth.surface)});
  const TransferredModel result = transfer_model(model, truth.surface, map);
  EXPECT_NO_THROW(check_model(result.model));
  EXPECT_TRUE(result.distorted.empty());
  for (std::size_t i = 0; i < 4; ++i) {
    const ContactModel &is = result.model.contacts[i], &should = truth.contacts[i];
    EXPECT_LT((is.position - should.position).norm(), 1e-6);
    EXPECT_LT((is.frame - should.frame).norm(), 1e-6);
    EXPECT_LT((is.friction_axis - should.friction_axis).norm(), 1e-6);
    EXPECT_EQ(is.field, rounded(should.field));
    EXPECT_NEAR(is.friction, should.friction, 1e-9);
  }
  const Vector3d displacement = motion.linear() * kDisplacement;
  EXPECT_LT((BlendedField(result.model).force(motion * model.contacts[1].position, displacement) -
             BlendedField(truth).force(motion * model.contacts[1].position, displacement))
                .norm(),
            1e-5);  // [N] fields are rounded
}

TEST(TransferModel, ScalesForcesAsScalingDoes) {
  Model model = with_compliances(uneven_model(), 2);
  model.probe_radius = 3;
  for (const ForceScaling forces :
       {ForceScaling::material, ForceScaling::forces, ForceScaling::feel}) {
    const Model truth = scale_model(model, {.factor = 1.6, .forces = forces}).model;
    const geometry::SurfaceMap map =
        geometry::map_surface(model.surface, truth.surface,
                              {.source = corners(model.surface), .target = corners(truth.surface)});
    const TransferredModel result = transfer_model(model, truth.surface, map, {.forces = forces});
    for (std::size_t i = 0; i < 4; ++i) {
      const ContactModel &is = result.model.contacts[i], &should = truth.contacts[i];
      EXPECT_LT((is.position - should.position).norm(), 1e-6);
      EXPECT_LT((force(is.field, kDisplacement) - force(should.field, kDisplacement)).norm(), 1e-6);
      EXPECT_NEAR(is.rms, should.rms, 1e-9);
      ASSERT_EQ(is.compliance.has_value(), should.compliance.has_value());
      if (!is.compliance) continue;
      EXPECT_LT((is.compliance->values - should.compliance->values).norm(), 1e-5);
    }
    EXPECT_NEAR(result.model.probe_radius.value(), truth.probe_radius.value(), 1e-6);
    EXPECT_NEAR(result.model.interpolation.reference_force, truth.interpolation.reference_force,
                1e-6);
  }
}

TEST(TransferModel, BlendsForcesByTheStrengthsOfTheContactsThere) {
  const Model model = hump_model(14);
  Eigen::Affine3d pose(some_motion());
  pose.scale(1.5);
  geometry::TriangleMesh target = model.surface;
  target.vertices = pose * target.vertices;
  const geometry::SurfaceMap map = geometry::map_surface(
      model.surface, target, {.source = corners(model.surface), .target = corners(target)});
  const Model there =
      transfer_model(with_strengths(model, 6), target, map, {.forces = ForceScaling::material})
          .model;
  EXPECT_NO_THROW(check_model(there));
  EXPECT_EQ(there.interpolation.rule, BlendRule::forces);
  EXPECT_NEAR(there.interpolation.reference_depth, 1.5 * 6, 1e-6);
  expect_strengths_of_hump(there, pose);
}

TEST(TransferModel, TriangulatesAsTheModelAndKeepsNothingOfTheAcquisition) {
  Model model = ball_model([](const Vector3d&) { return true; }, [](int) { return 0.0; }, 12);
  model.samples_fingerprint = "0123456789abcdef";
  model.pressing_offsets.emplace();
  Eigen::Matrix3Xd marks(3, 5);
  marks << 40, 0, 0, -40, 0, 0, 40, 0, 0, 0, 0, 0, 40, 0, -40;
  const geometry::SurfaceMap map =
      geometry::map_surface(model.surface, model.surface, {.source = marks, .target = marks});
  std::vector<Eigen::Matrix3Xi> triangles;
  using enum geometry::ContactTriangulationMethod;
  for (const auto method : {delaunay, voronoi_dual}) {
    model.triangulation = method;
    const Model result = transfer_model(model, model.surface, map).model;
    EXPECT_EQ(result.triangulation, method);
    EXPECT_FALSE(result.samples_fingerprint || result.pressing_offsets);
    triangles.push_back(result.triangles);
    model.made["triangulation"] = "voronoi_dual";  // for people
    EXPECT_EQ(transfer_model(model, model.surface, map).model.triangles, triangles.back());
    model.made.clear();
  }
  EXPECT_NE(triangles[0], triangles[1]);
}

TEST(TransferModel, FeelsOnAnEllipsoidLikeTheBallAtTheSamePlace) {
  const Model ball = ball_model([](const Vector3d&) { return true; }, [](int) { return 0.0; }, 60);
  const Vector3d stretch(1.2, 1, 0.9);
  geometry::TriangleMesh ellipsoid = geometry::test::icosphere(3, kSphereRadius);
  ellipsoid.vertices = stretch.asDiagonal() * ellipsoid.vertices;
  Eigen::Matrix3Xd marks(3, 5);
  marks << 40, 0, 0, -40, 0, 0, 40, 0, 0, 0, 0, 0, 40, 0, -40;
  const geometry::SurfaceMap map = geometry::map_surface(
      ball.surface, ellipsoid, {.source = marks, .target = stretch.asDiagonal() * marks});
  const TransferredModel result = transfer_model(ball, ellipsoid, map);
  EXPECT_NO_THROW(check_model(result.model));
  for (std::size_t i = 0; i < ball.contacts.size(); ++i) {
    const ContactModel &is = result.model.contacts[i], &was = ball.contacts[i];
    EXPECT_LT((is.position - stretch.cwiseProduct(was.position)).norm(), 0.4);  // [mm] facets
    // The direction of pressing stays a normal.
    const Vector3d inward = -stretch.cwiseInverse().cwiseProduct(was.position).normalized();
    EXPECT_LT((is.frame.col(2) - inward).norm(), 0.1);
    EXPECT_EQ(is.field, rounded(was.field));
  }
}

TEST(TransferModel, RefusesAMapThatIsNotSensibleOrOfAnotherSurface) {
  const Model model = uneven_model();
  geometry::SurfaceMap map =
      geometry::map_surface(model.surface, model.surface,
                            {.source = corners(model.surface), .target = corners(model.surface)});
  EXPECT_THAT(refusal([&] { return transfer_model(model, flat_surface(), {}); }),
              HasSubstr("the map is of a surface of 0 vertices"));
  map.distorted.setConstant(true);
  EXPECT_EQ(transfer_model(model, model.surface, map).distorted.size(), 4u);
  map.verdict = geometry::SurfaceMapVerdict::not_sensible;
  map.reason = "30 % of the area is folded";
  EXPECT_THAT(refusal([&] { return transfer_model(model, model.surface, map); }),
              HasSubstr("30 % of the area is folded"));
}

}  // namespace
}  // namespace palpate::haptics
