// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/closed_form.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "not_finite.h"
#include "palpate/core/error.h"
#include "refusal.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

constexpr double kEquilibrium = 1e-8;  // [mm] of Newton's method, on displacements up to 30 mm

// The energy of the sheet without a block as the header states it.
double sheet_energy(const Sheet& sheet, double x, double y, const Vector3d& e) {
  double energy = 0;
  for (const double side : {1.0, -1.0}) {
    const double length = sheet.support + side * x;
    const double longer = (e + side * length * Vector3d::UnitX()).norm() - length;
    energy += sheet.tension * longer + sheet.axial / (2 * length) * longer * longer;
  }
  return (1 - sheet.taper * y * y / (75.0 * 75.0)) * energy + sheet.lateral / 2 * e.y() * e.y();
}

TEST(ClosedForm, TheSheetIsInEquilibriumWithItsEnergy) {
  const Sheet sheet{.tension = 0.7, .axial = 31};
  for (const Vector3d& force : {Vector3d(0.3, -0.2, 0.9), Vector3d(-1.1, 0.4, 2.4)}) {
    const Vector3d e = displacement_at(sheet, 13, -27, force) - sheet.compliance * force;
    constexpr double kStep = 1e-4;  // [mm]; differences of 10 N mm are exact to 1e-11 N
    for (int k = 0; k < 3; ++k) {
      const Vector3d d = kStep * Vector3d::Unit(k);
      EXPECT_NEAR(
          (sheet_energy(sheet, 13, -27, e + d) - sheet_energy(sheet, 13, -27, e - d)) / (2 * kStep),
          force[k], 1e-7);
    }
  }
}

// By hand: pressed in its middle the sheet makes two straight segments, so that
// f = 2 (tension + axial (l - L) / L) e / l.
TEST(ClosedForm, TheSheetSagsAsTwoSpringsDo) {
  const Sheet sheet;
  const double sag = 9, length = std::hypot(50, sag);
  const double force = 2 * (0.8 + 42 * (length - 50) / 50) * sag / length;
  EXPECT_NEAR(displacement_at(sheet, 0, 0, {0, 0, force}).z(), sag + 0.25 * force, kEquilibrium);
}

TEST(ClosedForm, TheBlockStopsTheSheetOnlyAboveIt) {
  const Sheet free, blocked{.block = 1.5, .softness = 0.05};
  const Vector3d force(0, 0, 3);
  // Far inside its edges and well below its top, the block is a spring beside the sheet.
  const Vector3d e = displacement_at(blocked, 20, 0, force) - free.compliance * force;
  const Vector3d d(0, 0, 1e-4);
  const double by_sheet =
      (sheet_energy(free, 20, 0, e + d) - sheet_energy(free, 20, 0, e - d)) / 2e-4;
  EXPECT_GT(e.z(), 15.3);
  EXPECT_NEAR(by_sheet + 1.5 * (e.z() - 15), 3, 0.03);
  EXPECT_LT(e.z() + 1, displacement_at(free, 20, 0, force).z());
  EXPECT_NEAR(
      (displacement_at(blocked, -20, 0, force) - displacement_at(free, -20, 0, force)).norm(), 0,
      1e-3);
}

TEST(ClosedForm, TheBeamBendsAsACantilever) {
  const Beam beam;
  const auto bent = [&](double x) {
    return displacement_at(beam, x, 0, {0, 0, 1e-3}).z() - indentation(beam, {0, 0, 1e-3}).z();
  };
  EXPECT_NEAR(bent(200), 4e-3, 1e-12);  // `bending` at the tip
  EXPECT_NEAR(bent(100), 0.5e-3, 1e-12);
  // Maxwell: the compliance is symmetric, and so is its effect on work.
  const Eigen::Matrix3d compliance = bending_compliance(beam, 130, 11);
  EXPECT_LT((compliance - compliance.transpose()).norm(), 1e-15);
}

TEST(ClosedForm, TheElasticBodyHasJohnsonsStiffness) {
  const ElasticBody body{.young_modulus = 0.1, .poisson_ratio = 0.5, .tool_radius = 3};
  // 2 a E / (1 - nu^2) = 0.8 N/mm and 4 a E / ((1 + nu) (2 - nu)) = 1.2 / 2.25 N/mm.
  EXPECT_NEAR(displacement_at(body, 0, 0, {0, 0, 1.6}).z(), 2, 1e-12);
  EXPECT_NEAR(displacement_at(body, 0, 0, {1.2, 0, 1}).x(), 2.25, 1e-12);
}

std::vector<std::unique_ptr<Specimen>> all_specimens() {
  std::vector<std::unique_ptr<Specimen>> all;
  all.push_back(make_specimen(Sheet{.block = 1.5}));
  all.push_back(make_specimen(Beam{}));
  all.push_back(make_specimen(ElasticBody{}));
  return all;
}

TEST(ClosedForm, SurfacesFaceTheCameraAndForcesIntoThemPressThemIn) {
  for (const auto& specimen : all_specimens()) {
    const geometry::TriangleMesh& mesh = specimen->surface();
    const Eigen::Matrix3Xd normals = geometry::triangle_normals(mesh);
    EXPECT_LT(normals.row(2).maxCoeff(), -0.9);
    for (Eigen::Index v = 5; v < mesh.vertices.cols(); v += 997) {
      const Vector3d at = mesh.vertices.col(v);
      const FrictionCone cone = specimen->friction_cone(at);
      EXPECT_NEAR(cone.axis.norm(), 1, 1e-12);
      EXPECT_GT(cone.axis.z(), 0.9);
      const Vector3d force = 0.7 * cone.axis + Vector3d(0.1, 0, 0);
      EXPECT_GT(specimen->displacement(at, force).dot(force), 0);
      EXPECT_EQ(specimen->displacement(at, Vector3d::Zero()).norm(), 0);
    }
  }
}

// In the world frame the specimen says what the local functions say.
TEST(ClosedForm, SpecimensTurnVectorsIntoTheWorldFrame) {
  const Sheet sheet;
  const auto specimen = make_specimen(sheet);
  const Vector3d at = surface_at(sheet, 21, -33), force(0.4, -0.3, 1.9);
  const Eigen::Matrix3d frame = frame_at(sheet, 21, -33);
  EXPECT_LT(
      (frame * specimen->displacement(at, force) - displacement_at(sheet, 21, -33, frame * force))
          .norm(),
      kEquilibrium);
  EXPECT_LT((frame.transpose() * frame - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  // Places beside the surface are moved to its edge.
  EXPECT_EQ(specimen->displacement({21, -500, 0}, force),
            specimen->displacement(surface_at(sheet, 21, -70), force));
}

// [mm] Boussinesq's and Cerruti's point loads (Johnson 3.17, 3.75), added up over the tool's disc.
Vector3d sum_of_point_loads(const ElasticBody& body, const Eigen::Vector2d& beside,
                            const Vector3d& force) {
  const double nu = body.poisson_ratio, shear = body.young_modulus / (2 * (1 + nu));
  constexpr int kRadial = 400, kAround = 400;
  Vector3d sum = Vector3d::Zero();
  for (int i = 0; i < kRadial; ++i) {
    const double phi = std::numbers::pi / 2 * (i + 0.5) / kRadial;  // r = a sin phi
    const double r = body.tool_radius * std::sin(phi);
    const double share = std::numbers::pi / 2 / kRadial * std::sin(phi) / kAround;
    for (int j = 0; j < kAround; ++j) {
      const double angle = 2 * std::numbers::pi * (j + 0.5) / kAround;
      const Eigen::Vector2d x = beside - r * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      const double s = x.norm(), along = x.dot(force.head<2>());
      sum.head<2>() += share / (2 * std::numbers::pi * shear) *
                       ((1 - nu) / s * force.head<2>() + nu * along / (s * s * s) * x -
                        (1 - 2 * nu) / 2 * force.z() / (s * s) * x);
      sum.z() += share / (2 * std::numbers::pi * shear) *
                 ((1 - nu) / s * force.z() + (1 - 2 * nu) / 2 * along / (s * s));
    }
  }
  return sum;
}

TEST(ClosedForm, TheSurfaceOfTheElasticBodyMovesAsItsPointLoadsAddUp) {
  const Vector3d force(0.4, -0.3, 1.1);
  for (const double nu : {0.3, 0.5}) {
    const ElasticBody body{.young_modulus = 0.1, .poisson_ratio = nu, .tool_radius = 4};
    for (const Eigen::Vector2d& beside :
         {Eigen::Vector2d(7, 2), Eigen::Vector2d(-4.5, 3), Eigen::Vector2d(1, -30)}) {
      const Vector3d exact = sum_of_point_loads(body, beside, force);
      EXPECT_LT((displacement_beside(body, beside, force) - exact).norm(), 2e-3 * exact.norm());
    }
    // Below the tool, points move as the tool; for nu < 1/2, up to what the header says.
    const Vector3d tool = displacement_at(body, 0, 0, force);
    const double allowed = (1 - 2 * nu) / (std::numbers::pi * (1 - nu)) * tool.norm();
    for (const double r : {0.0, 1.7, 3.9, 4.0})
      EXPECT_LE((displacement_beside(body, {r, 0}, force) - tool).norm(), allowed + 1e-12) << r;
    EXPECT_LT((displacement_beside(body, {0, 0}, force) - tool).norm(), 1e-12);
  }
}

TEST(ClosedForm, OnlyObjectsWithAFieldKnowTheirShape) {
  const auto body = make_specimen(ElasticBody{.young_modulus = 0.1});
  const Vector3d at(4, -6, 700), force(0.2, 0, 1);
  ASSERT_TRUE(body->knows_shape());
  const Eigen::Matrix3Xd moved = body->deformed_surface(at, force) - body->surface().vertices;
  for (Eigen::Index v = 0; v < moved.cols(); ++v) {
    if ((body->surface().vertices.col(v) - at).norm() > 1e-9) continue;
    EXPECT_LT((moved.col(v) - body->displacement(at, force)).norm(), 1e-12);
  }
  EXPECT_LT(moved.row(2).minCoeff(), 0.1 * moved.row(2).maxCoeff());
  EXPECT_FALSE(make_specimen(Sheet{})->knows_shape());
  const auto beam = make_specimen(Beam{});
  EXPECT_THAT(refusal([&] { return beam->deformed_surface(at, force); }),
              ::testing::HasSubstr("elastic_body and finite_elements"));
}

TEST(ClosedForm, ConesHoldForcesInsideThemOnly) {
  const LocalCone cone{{0, 0, 1}, 0.5};
  EXPECT_TRUE(holds(cone, {0.49, 0, 1}));
  EXPECT_FALSE(holds(cone, {0.3, 0.41, 1}));
  EXPECT_FALSE(holds(cone, {0, 0, -1}));
}

TEST(ClosedForm, RefusesPlacesAndForcesThatAreNotFinite) {
  const auto specimen = make_specimen(Sheet{});
  const Vector3d at(1, 2, 700), force(0.1, 0, 1);
  for (const double wrong : {kNaN, kInf, -kInf}) {
    const Vector3d no_place(1, wrong, 700), no_force(0.1, 0, wrong);
    EXPECT_EQ(refusal([&] { return specimen->displacement(at, no_force); }).find("force is "), 0U);
    EXPECT_EQ(refusal([&] { return specimen->displacement(no_place, force); }).find("contact is "),
              0U);
    const auto body = make_specimen(ElasticBody{});
    EXPECT_EQ(refusal([&] { return body->deformed_surface(at, no_force); }).find("force is "), 0U);
    EXPECT_EQ(refusal([&] { return specimen->friction_cone(no_place); }).find("contact is "), 0U);
    EXPECT_EQ(refusal([&] { return specimen->at(at)->displacement(no_force); }).find("force is "),
              0U);
  }
}

TEST(ClosedForm, RefusesNumbersOutOfRange) {
  const auto message = [](const auto& object) -> std::string {
    try {
      (void)make_specimen(object);
    } catch (const InvalidInput& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_THAT(message(Sheet{.axial = 0}), ::testing::HasSubstr("Sheet::axial is 0"));
  EXPECT_THAT(message(Beam{.local_variation = 1}), ::testing::HasSubstr("Beam::local_variation"));
  EXPECT_THAT(message(ElasticBody{.poisson_ratio = 0.6}),
              ::testing::HasSubstr("ElasticBody::poisson_ratio"));
  EXPECT_THAT(message(Sheet{.block_low = {NAN, 0}}), ::testing::HasSubstr("Sheet::block_low"));
}

}  // namespace
}  // namespace palpate::probing
