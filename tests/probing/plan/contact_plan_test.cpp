// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/contact_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "palpate/core/error.h"
#include "palpate/geometry/geodesic_distance.h"
#include "refusal.h"
#include "test_surfaces.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;
using geometry::TriangleMesh;
using ::testing::AllOf;
using ::testing::HasSubstr;

// A height field before a sensor at the origin: z = 600 mm minus the height, turned towards it.
TriangleMesh seen(int cols, int rows, double spacing,
                  const std::function<double(double, double)>& height) {
  TriangleMesh mesh = geometry::test::height_field(
      cols, rows, spacing, [&](double x, double y) { return 600 - height(x, y); });
  mesh.triangles.row(1).swap(mesh.triangles.row(2));
  const double x = cols * spacing / 2, y = rows * spacing / 2;
  mesh.vertices.colwise() -= Vector3d(x, y, 0);
  return mesh;
}

TriangleMesh plane() {
  return seen(60, 50, 1.5, [](double, double) { return 0.0; });
}

TEST(ContactPlan, IsEvenAndLeavesOutTheBorder) {
  const TriangleMesh mesh = plane();
  const ContactPlan plan = plan_contacts(mesh, {.spacing = 12, .tip_radius = 4});
  ASSERT_GT(plan.contacts.size(), 25U);
  constexpr double kRounding = 1e-9;
  for (const Contact& contact : plan.contacts) {
    // 1.5 R from the border of 90 x 75 mm.
    EXPECT_LE(std::abs(contact.position.x()), 45 - 6 + kRounding);
    EXPECT_LE(std::abs(contact.position.y()), 37.5 - 6 + kRounding);
    EXPECT_LT((contact.normal - Vector3d(0, 0, -1)).norm(), kRounding);
    for (const Contact& other : plan.contacts) {
      if (other.id == contact.id) continue;
      EXPECT_GE((other.position - contact.position).norm(), 12 - kRounding);
    }
  }
  EXPECT_LT(plan.cover, 12);
  const auto count = [&](Eligibility kind) {
    return plan.excluded[static_cast<std::size_t>(kind)];
  };
  EXPECT_EQ(count(Eligibility::eligible), 53 * 43);  // vertices with 4 of 1.5 mm or more beside
  EXPECT_EQ(count(Eligibility::near_border), 61 * 51 - 53 * 43);
}

TEST(ContactPlan, APrefixIsTheCoarserPlan) {
  const ContactPlan fine = plan_contacts(plane(), {.spacing = 6});
  const ContactPlan coarse = plan_contacts(plane(), {.spacing = 6, .contacts = 9});
  ASSERT_EQ(coarse.contacts.size(), 9U);
  for (std::size_t i = 0; i < 9; ++i)
    EXPECT_EQ(coarse.contacts[i].position, fine.contacts[i].position);
}

TEST(ContactPlan, TheGridHasShiftedLines) {
  const ContactPlan plan =
      plan_contacts(plane(), {.pattern = PlanPattern::grid, .spacing = 12, .tip_radius = 2});
  ASSERT_GT(plan.contacts.size(), 35U);
  for (const Contact& contact : plan.contacts) {
    double nearest = 1e9;
    for (const Contact& other : plan.contacts) {
      if (other.id != contact.id)
        nearest = std::min(nearest, (other.position - contact.position).norm());
    }
    // Places are moved to vertices, by up to half the diagonal of 1.5 mm.
    EXPECT_NEAR(nearest, 12, 2 * 1.07);
  }
  EXPECT_LT(plan.cover, 12);
}

// A cylindrical groove of radius 2 along y: a tip of radius 3 cannot reach its ground, one of
// radius 1.5 can.
TEST(ContactPlan, LeavesOutCavitiesTighterThanTheTip) {
  const TriangleMesh mesh = seen(160, 40, 0.25, [](double x, double) {
    const double u = x - 20;
    return std::abs(u) < 1.8 ? -(std::sqrt(4 - u * u) - std::sqrt(4 - 1.8 * 1.8)) : 0.0;
  });
  Eigen::Matrix3Xd normals;
  const auto at_ground = [&](double radius) {
    const std::vector<Eligibility> found = eligibility(mesh, {.tip_radius = radius}, normals);
    return found[static_cast<std::size_t>(20 * 161 + 80)];
  };
  EXPECT_EQ(at_ground(3), Eligibility::obstructed);
  EXPECT_EQ(at_ground(1.5), Eligibility::eligible);
  // A flat place 10 mm beside it is free for both.
  EXPECT_EQ(eligibility(mesh, {.tip_radius = 3}, normals)[20 * 161 + 40], Eligibility::eligible);
}

TEST(ContactPlan, LeavesOutWhatTheSensorSeesFromTheSide) {
  // A wave whose slopes reach atan(3) = 71.6 degrees.
  const TriangleMesh mesh =
      seen(240, 40, 0.5, [](double x, double) { return 30 * std::sin(x / 10); });
  constexpr double kDegree = std::numbers::pi / 180;
  Eigen::Matrix3Xd normals;
  const PlanOptions options{.tip_radius = 1, .view_angle = 50 * kDegree};
  const std::vector<Eligibility> found = eligibility(mesh, options, normals);
  int oblique = 0;
  for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) {
    const double x = mesh.vertices(0, v) + 60;
    const double slope = 3 * std::cos(x / 10);
    const Vector3d normal = Vector3d(-slope, 0, -1).normalized();
    const double angle = std::acos(-normal.dot(mesh.vertices.col(v).normalized()));
    if (found[static_cast<std::size_t>(v)] == Eligibility::near_border) continue;
    if (std::abs(angle - options.view_angle) < 2 * kDegree) continue;  // of fitted normals
    EXPECT_EQ(found[static_cast<std::size_t>(v)] == Eligibility::oblique,
              angle > options.view_angle)
        << x << ' ' << angle;
    oblique += angle > options.view_angle ? 1 : 0;
  }
  EXPECT_GT(oblique, 1000);
}

TEST(ContactPlan, NormalsAreFittedOverTheTip) {
  // Bumps of 0.4 mm height and 2 mm length tilt triangles by up to 50 degrees.
  const TriangleMesh rough = seen(120, 120, 0.25, [](double x, double y) {
    return 0.4 * std::sin(x * std::numbers::pi) * std::sin(y * std::numbers::pi);
  });
  const ContactPlan plan = plan_contacts(rough, {.spacing = 5, .tip_radius = 3});
  for (const Contact& contact : plan.contacts)
    EXPECT_LT((contact.normal - Vector3d(0, 0, -1)).norm(), 0.05);
}

TEST(ContactPlan, SaysWhyNoPlaceIsLeft) {
  const auto message = [](const TriangleMesh& mesh, const PlanOptions& options) -> std::string {
    try {
      (void)plan_contacts(mesh, options);
    } catch (const InvalidInput& e) {
      return e.what();
    }
    return "";
  };
  TriangleMesh inwards = plane();
  inwards.triangles.row(1).swap(inwards.triangles.row(2));
  EXPECT_THAT(message(inwards, {}), HasSubstr("oblique. Are the triangles turned inwards"));
  EXPECT_THAT(message(plane(), {.tip_radius = 30}), HasSubstr("3111 near_border. A smaller tip"));
  EXPECT_THAT(message(plane(), {.spacing = 0}), HasSubstr("PlanOptions::spacing is 0"));
  EXPECT_THAT(message(plane(), {.highest_force = 4}), HasSubstr("PlanOptions::max_force is 3"));
  EXPECT_THAT(message(plane(), {.levels = 0}), HasSubstr("PlanOptions::levels is 0"));
  EXPECT_THAT(message(TriangleMesh{}, {}), HasSubstr("triangle"));
}

TEST(ContactPlan, RefusesASpacingAndATipThatDoNotSuitTheSurface) {
  const auto message = [](const PlanOptions& options) {
    return refusal([&] { return plan_contacts(plane(), options); });
  };
  const PlanPattern grid = PlanPattern::grid;
  // 90 x 75 mm: a grid of 0.28 mm has 100,000 places.
  for (const double spacing : {0.25, 1e-3, 1e-100}) {
    EXPECT_THAT(message({.pattern = grid, .spacing = spacing}),
                AllOf(HasSubstr("PlanOptions::spacing"), HasSubstr("it must be >= 0.279")));
    EXPECT_THAT(message({.pattern = grid, .spacing = spacing, .contacts = 3}),
                HasSubstr("PlanOptions::spacing"));
  }
  for (const double radius : {120.0, 1e155})
    EXPECT_THAT(message({.tip_radius = radius}), HasSubstr("PlanOptions::tip_radius"));
  EXPECT_THAT(message({.highest_force = 1e155, .max_force = 1e155}),
              HasSubstr("PlanOptions::highest_force"));
  // In farthest-point order there are no more contacts than vertices.
  const TriangleMesh coarse = seen(6, 5, 15, [](double, double) { return 0.0; });
  EXPECT_EQ(plan_contacts(coarse, {.spacing = 1e-100, .border = 0}).contacts.size(), 7U * 6U);
}

TEST(ContactPlan, LevelsAreInProportionToTheLargestForce) {
  const ContactPlan weak = plan_contacts(plane(), {.max_force = 1.5});
  EXPECT_NEAR(weak.normal_forces.back(), 1.3, 1e-12);  // as 2.6 N of 3 N
  EXPECT_EQ(weak.options.highest_force, weak.normal_forces.back());
  EXPECT_EQ(weak.normal_forces.front(), 0.15);
  EXPECT_EQ(plan_contacts(plane(), {.highest_force = 1, .max_force = 1.5}).normal_forces.back(), 1);
  EXPECT_THAT(refusal([] { return plan_contacts(plane(), {.max_force = 0.1}); }),
              HasSubstr("lowest_force is 0.15 N; it must be in (0, 0.0866"));
}

TEST(ContactPlan, LevelsAreGeometricAndDirectionsEven) {
  const ContactPlan plan = plan_contacts(plane(), {});
  ASSERT_EQ(plan.normal_forces.size(), 6U);
  for (std::size_t i = 2; i < 6; ++i) {
    EXPECT_NEAR(plan.normal_forces[i] / plan.normal_forces[i - 1],
                plan.normal_forces[1] / plan.normal_forces[0], 1e-12);
  }
  EXPECT_EQ(plan.normal_forces.back(), 2.6);
  EXPECT_NEAR(direction_angle(plan.options, 2, 3) - direction_angle(plan.options, 2, 2),
              std::numbers::pi / 2, 1e-12);
  const Contact contact{.normal = Vector3d(0.3, -0.4, -0.9).normalized()};
  const Eigen::Matrix3d frame = tangent_frame(contact);
  EXPECT_LT((frame.transpose() * frame - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  EXPECT_NEAR(frame.determinant(), 1, 1e-12);
  EXPECT_LT((frame.col(2) + contact.normal).norm(), 1e-12);
}

}  // namespace
}  // namespace palpate::probing
