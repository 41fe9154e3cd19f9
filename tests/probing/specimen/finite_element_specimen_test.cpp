// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/finite_element_specimen.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "not_finite.h"
#include "palpate/core/error.h"
#include "palpate/geometry/triangle_mesh.h"
#include "palpate/probing/specimen_file.h"
#include "refusal.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;

constexpr const char* kBlock = R"({"type": "finite_elements", "size": [40, 40, 16],
  "cells": [4, 4, 2], "shear_modulus": 0.05, "friction": 0.6})";

std::string with_member(const std::string& member) {
  std::string text = kBlock;
  return text.insert(text.rfind('}'), ", " + member);
}

std::string refused_solid(const std::string& text) {
  try {
    (void)parse_specimen(text, "a.json");
  } catch (const FileError& e) {
    return e.what();
  }
  return "";
}

TEST(FiniteElementSpecimen, ShowsItsFreeSideToTheCamera) {
  const auto block = parse_specimen(kBlock, "");
  EXPECT_EQ(block->surface().vertices.cols(), 9 * 9);
  EXPECT_TRUE((block->surface().vertices.row(2).array() == 700).all());
  const Eigen::Matrix3Xd normals = geometry::triangle_normals(block->surface());
  for (const Vector3d normal : normals.colwise())
    EXPECT_LT((normal + Vector3d::UnitZ()).norm(), 1e-12);
  const FrictionCone cone = block->friction_cone({1, 2, 700});
  EXPECT_EQ(cone.coefficient, 0.6);
  EXPECT_LT((cone.axis - Vector3d::UnitZ()).norm(), 1e-12);

  const auto ball = parse_specimen(
      R"({"type": "finite_elements", "shape": "ball", "radius": 20, "cells": 6})", "");
  const Vector3d centre(0, 0, 720);
  for (const Vector3d at : ball->surface().vertices.colwise())
    EXPECT_NEAR((at - centre).norm(), 20, 1e-9);
  const Vector3d at(6, -4, 702);
  const Vector3d inward = (centre - at).normalized();
  EXPECT_GT(ball->friction_cone(at).axis.dot(inward), 0.999);
}

TEST(FiniteElementSpecimen, MovesWithTheForceWhateverCameBefore) {
  const auto block = parse_specimen(kBlock, ""), other = parse_specimen(kBlock, "");
  const Vector3d at(1, 2, 700), force(0.2, -0.1, 1);
  const Vector3d moved = block->displacement(at, force);
  EXPECT_GT(moved.z(), 0.5);
  EXPECT_GT(moved.x(), 0.05);
  EXPECT_LT(moved.y(), -0.02);
  EXPECT_EQ(block->displacement(at, Vector3d::Zero()), Vector3d::Zero());
  (void)other->displacement({-8, 5, 700}, 2 * force);
  (void)other->displacement(at, 0.3 * force);
  EXPECT_EQ(other->displacement(at, force), moved);
  EXPECT_THROW((void)block->displacement(at, -force), SolverError);
}

TEST(FiniteElementSpecimen, ShowsWhereItsSurfaceIsUnderAForce) {
  const auto block = parse_specimen(kBlock, "");
  ASSERT_TRUE(block->knows_shape());
  const Vector3d at(0, 0, 700), force(0.1, 0, 1);
  const Eigen::Matrix3Xd& rest = block->surface().vertices;
  const Eigen::Matrix3Xd moved = block->deformed_surface(at, force) - rest;
  const Vector3d tip = block->displacement(at, force);
  for (Eigen::Index v = 0; v < rest.cols(); ++v) {
    const double away = (rest.col(v) - at).norm();
    // The centre of the tip is nearer than the surface by the penalty of the contact.
    if (away < 1e-9) {
      EXPECT_LT((moved.col(v) - tip).norm(), 0.1 * tip.norm());
    } else if (away > 15) {
      EXPECT_LT(moved.col(v).norm(), 0.3 * tip.norm());
    }
  }
  EXPECT_THROW((void)block->deformed_surface(at, -force), SolverError);
}

TEST(FiniteElementSpecimen, RefusesPlacesAndForcesThatAreNotFinite) {
  const auto block = parse_specimen(kBlock, "");
  const Vector3d at(1, 2, 700), force(0.1, 0, 1);
  for (const double wrong : {kNaN, kInf}) {
    const Vector3d no_place(1, wrong, 700), no_force(0.1, 0, wrong);
    EXPECT_THAT(refusal([&] { return block->displacement(at, no_force); }), HasSubstr("force is "));
    EXPECT_THAT(refusal([&] { return block->at(at)->displacement(no_force); }),
                HasSubstr("force is "));
    EXPECT_THAT(refusal([&] { return block->displacement(no_place, force); }),
                HasSubstr("contact is "));
  }
}

TEST(FiniteElementSpecimen, MovesTheSameWhenManyForcesAreAskedAtOneContact) {
  const auto block = parse_specimen(kBlock, "");
  const Vector3d at(1, 2, 700);
  const auto contact = block->at(at);
  for (const Vector3d& force : {Vector3d(0, 0, 0.5), Vector3d(0.2, -0.1, 1), Vector3d(0, 0.4, 1.1)})
    EXPECT_LT((contact->displacement(force) - block->displacement(at, force)).norm(), 1e-4);
  EXPECT_THROW((void)contact->displacement({0, 0, -1}), SolverError);
}

TEST(FiniteElementSpecimen, HasRegionsSupportsAndObstacles) {
  const Vector3d at(0, 0, 700), force(0, 0, 1);
  const double soft = parse_specimen(kBlock, "")->displacement(at, force).z();
  const auto depth = [&](const std::string& member) {
    return parse_specimen(with_member(member), "a.json")->displacement(at, force).z();
  };
  EXPECT_LT(depth(R"("regions": [{"low": [-10, -10, 700], "high": [10, 10, 716],
                     "shear_modulus": 0.5}])"),
            0.5 * soft);
  EXPECT_LT(depth(R"("regions": [{"centre": [0, 0, 708], "radius": 8, "shear_modulus": 0.5}])"),
            0.95 * soft);
  EXPECT_GT(depth(R"("supports": [{"side": "left"}, {"side": "right"}])"), 1.05 * soft);
  EXPECT_LT(depth(R"("supports": [{"side": "left"}, {"side": "right"}],
                     "obstacles": [{"low": [-30, -30, 716.2], "high": [30, 30, 730]}])"),
            depth(R"("supports": [{"side": "left"}, {"side": "right"}])"));
}

TEST(FiniteElementSpecimen, SaysWhatIsWrongWithItsFile) {
  EXPECT_THAT(refused_solid(with_member(R"("tension": 1)")),
              HasSubstr("a.json: at /tension: 'tension' is unknown; there are type, shape, size"));
  EXPECT_THAT(refused_solid(with_member(R"("bulk_modulus": 600)")),
              HasSubstr("at the top: 'bulk_modulus' is 600"));
  EXPECT_THAT(refused_solid(with_member(R"("supports": [{"side": "inside"}])")),
              HasSubstr("at /supports/0/side: found \"inside\", expected \"left\", \"back\""));
  EXPECT_THAT(
      refused_solid(with_member(R"("supports": [{"low": [90, 0, 0], "high": [99, 1, 1]}])")),
      HasSubstr("at /supports/0: holds no node"));
  EXPECT_THAT(refused_solid(with_member(R"("supports": [])")), HasSubstr("has no 'supports'"));
  EXPECT_THAT(refused_solid(with_member(R"("supports": [{"side": "left", "low": [0, 0, 0]}])")),
              HasSubstr("'low' is unknown"));
  EXPECT_THAT(refused_solid(with_member(R"("regions": [{"low": [0, 0, 0], "high": [1, 1, 1]}])")),
              HasSubstr("at /regions/0: holds the middle of no element"));
  EXPECT_THAT(
      refused_solid(with_member(R"("shape": "cone")")),
      HasSubstr("a.json: at /shape: found \"cone\", expected \"block\", \"ball\" or \"mesh\""));
  EXPECT_THAT(refused_solid(R"({"type": "finite_elements", "cells": [2, 2.5, 1]})"),
              HasSubstr("at /cells: found [2,2.5,1], expected three whole numbers"));
  EXPECT_THAT(refused_solid(R"({"type": "finite_elements", "size": [0.04, 0.04, 0.02]})"),
              HasSubstr("it seems to be in metres"));
  EXPECT_THAT(refused_solid(R"({"type": "finite_elements", "shape": "mesh", "file": "no.msh"})"),
              HasSubstr("no.msh: cannot be read"));
  EXPECT_THAT(refused_solid(with_member(R"("supports": [{"side": "top"}])")),
              HasSubstr("sees no free part"));
}

}  // namespace
}  // namespace palpate::probing
