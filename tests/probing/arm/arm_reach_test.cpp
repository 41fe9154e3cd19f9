// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/arm_reach.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "not_finite.h"
#include "palpate/core/error.h"
#include "palpate/probing/arm_setup.h"
#include "palpate/probing/closed_form.h"
#include "test_surfaces.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

ReachOptions options_over(const Specimen& specimen) {
  ReachOptions options;
  options.T_world_base = mount_over(specimen.surface(), options.geometry);
  return options;
}

TEST(ArmReach, AgreesWithForwardKinematicsOfJointsInsideAndOutsideTheirRange) {
  ReachOptions options;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> turn(-2, 2), upper(-1.2, 1.9), bend(-1.3, 1.3);
  int inside = 0, outside = 0;
  for (int i = 0; i < 10000; ++i) {
    Vector3d joints{turn(random), upper(random), 0};
    joints[2] = joints[1] + bend(random);
    const Vector3d tip = tip_position(options.geometry, joints);
    const double radius =
        options.geometry.upper * std::cos(joints[1]) + options.geometry.lower * std::sin(joints[2]);
    if (radius < 2 * options.margin) continue;  // the inverse takes another branch there
    const double sum = options.geometry.upper + options.geometry.lower;
    const double difference = options.geometry.upper - options.geometry.lower;
    const bool in_range = (joints.array() >= options.lowest_joints.array()).all() &&
                          (joints.array() <= options.highest_joints.array()).all();
    const Reach expected = tip.norm() > sum - options.margin          ? Reach::too_far
                           : tip.norm() < difference + options.margin ? Reach::too_near
                           : in_range                                 ? Reach::reachable
                                                                      : Reach::joint_limit;
    EXPECT_EQ(reach_of(tip, options), expected) << joints.transpose();
    (expected == Reach::reachable ? inside : outside) += 1;
  }
  EXPECT_GT(inside, 1000);
  EXPECT_GT(outside, 1000);
}

TEST(ArmReach, AnArmMountedOverASheetReachesItsWholePlan) {
  const std::shared_ptr<const Specimen> sheet = make_specimen(Sheet{});
  const ContactPlan plan = plan_contacts(sheet->surface());
  const geometry::SurfaceQuery query(sheet->surface());
  const PlanReach reach = reach_of_plan(plan, options_over(*sheet), &query);
  EXPECT_EQ(reach.counts[0], static_cast<int>(plan.contacts.size()));
}

// Distances by exhaustive search and by formulas (Ericson 2005, sections 5.1.5 and 5.1.9).
double distance_of_point(const Vector3d& p, const Vector3d& a, const Vector3d& b,
                         const Vector3d& c) {
  const Vector3d n = (b - a).cross(c - a);
  const Vector3d foot = p - n * (n.dot(p - a) / n.squaredNorm());
  const bool inside = (b - a).cross(foot - a).dot(n) >= 0 && (c - b).cross(foot - b).dot(n) >= 0 &&
                      (a - c).cross(foot - c).dot(n) >= 0;
  return inside ? (foot - p).norm() : std::numeric_limits<double>::infinity();
}

double distance_of_segments(const Vector3d& p, const Vector3d& q, const Vector3d& a,
                            const Vector3d& b) {
  const Vector3d d1 = q - p, d2 = b - a, r = p - a;
  const double e = d2.squaredNorm(), f = d2.dot(r), c = d1.dot(r), g = d1.dot(d2);
  const double length = d1.squaredNorm(), denominator = length * e - g * g;
  double s = denominator > 0 ? std::clamp((g * f - c * e) / denominator, 0.0, 1.0) : 0;
  const double t = std::clamp((g * s + f) / e, 0.0, 1.0);
  s = std::clamp((g * t - c) / length, 0.0, 1.0);
  return (p + s * d1 - a - t * d2).norm();
}

double distance_by_search(const Vector3d& p, const Vector3d& q,
                          const geometry::TriangleMesh& mesh) {
  double nearest = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < mesh.triangles.cols(); ++i) {
    const Vector3d a = mesh.vertices.col(mesh.triangles(0, i)),
                   b = mesh.vertices.col(mesh.triangles(1, i)),
                   c = mesh.vertices.col(mesh.triangles(2, i)), n = (b - a).cross(c - a);
    const double from = n.dot(p - a), to = n.dot(q - a);
    if (from * to <= 0 && from != to) {
      const Vector3d crossing = p + from / (from - to) * (q - p);
      if (distance_of_point(crossing, a, b, c) < 1e-9) return 0;
    }
    nearest = std::min({nearest, distance_of_point(p, a, b, c), distance_of_point(q, a, b, c),
                        distance_of_segments(p, q, a, b), distance_of_segments(p, q, b, c),
                        distance_of_segments(p, q, c, a)});
  }
  return nearest;
}

/// Below the arm, with a ridge of 60 mm across it.
geometry::TriangleMesh ridged_ground() {
  geometry::TriangleMesh mesh = geometry::test::height_field(
      12, 12, 20, [](double, double y) { return 60 * std::exp(-std::pow((y - 100) / 25, 2)); });
  // Its height is along y in the frame of the base.
  const Eigen::Matrix3Xd flat = mesh.vertices;
  mesh.vertices.row(0) = flat.row(0).array() - 120;
  mesh.vertices.row(1) = flat.row(2).array() - 150;
  mesh.vertices.row(2) = flat.row(1).array() + 30;
  return mesh;
}

TEST(ArmReach, LinksStayAwayFromTheSurfaceAsASearchOfAllTrianglesSays) {
  const geometry::TriangleMesh ground = ridged_ground();
  const geometry::SurfaceQuery query(ground);
  const ReachOptions options;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> turn(-0.7, 0.7), upper(-0.4, 0.6), lower(-0.7, 0.7);
  int clear = 0, near = 0;
  for (int i = 0; i < 10000; ++i) {
    const Vector3d joints{turn(random), upper(random), lower(random)};
    const Vector3d tip = tip_position(options.geometry, joints);
    const Vector3d elbow =
        tip_position({options.geometry.upper, 1e-9}, Vector3d(joints[0], joints[1], 0));
    const Vector3d held = tip + options.links.free_end / options.geometry.lower * (elbow - tip);
    const double distance = std::min(distance_by_search(elbow, held, ground),
                                     distance_by_search(Vector3d::Zero(), elbow, ground));
    if (std::abs(distance - options.links.distance) < 0.06) continue;
    const bool expected = distance > options.links.distance;
    ASSERT_EQ(links_are_clear(tip, query, options), expected) << joints.transpose();
    (expected ? clear : near) += 1;
  }
  EXPECT_GT(clear, 1000);
  EXPECT_GT(near, 1000);
}

TEST(ArmReach, ExcludesAContactBehindARidgeThatALinkWouldTouch) {
  const geometry::TriangleMesh ground = ridged_ground();
  const geometry::SurfaceQuery query(ground);
  ContactPlan plan;
  plan.normal_forces = {0.5};
  plan.contacts = {{.id = 0, .position = {0, -148, 200}, .normal = {0, 1, 0}},
                   {.id = 1, .position = {0, -150, 75}, .normal = {0, 1, 0}}};
  ReachOptions options;
  options.depth = 0;
  options.links.distance = 8;
  for (const Contact& contact : plan.contacts)
    EXPECT_EQ(reach_of(contact, plan, options), Reach::reachable) << contact.id;
  PlanReach reach = reach_of_plan(plan, options, &query);
  EXPECT_EQ(reach.contacts[0], Reach::reachable);
  EXPECT_EQ(reach.contacts[1], Reach::collides);
  EXPECT_EQ(reach.counts[static_cast<std::size_t>(Reach::collides)], 1);
  EXPECT_STREQ(to_string(Reach::collides), "collides");
  options.links.distance = 1;
  options.links.free_end = 120;  // a long tip
  reach = reach_of_plan(plan, options, &query);
  EXPECT_EQ(reach.contacts[1], Reach::reachable);
}

TEST(ArmReach, NamesContactsThatAreTooFarAndForcesThatAreTooLarge) {
  const std::shared_ptr<const Specimen> sheet = make_specimen(Sheet{});
  ContactPlan plan = plan_contacts(sheet->surface(), {.contacts = 3});
  plan.contacts[1].position.y() += 500;
  plan.contacts[2].position.x() = kNaN;
  const ReachOptions options = options_over(*sheet);
  const PlanReach reach = reach_of_plan(plan, options);
  EXPECT_EQ(reach.contacts[0], Reach::reachable);
  EXPECT_EQ(reach.contacts[1], Reach::too_far);
  EXPECT_EQ(reach.contacts[2], Reach::too_far);
  EXPECT_EQ(reach.counts[static_cast<std::size_t>(Reach::too_far)], 2);

  // A vertical force has the lever r = l1 c1 + ... of joint 1: nowhere longer than l1.
  const double lever = options.geometry.upper;
  ContactPlan strong = plan_contacts(sheet->surface(), {.contacts = 1, .directions = 0});
  const auto with_force = [&](double force) {
    strong.normal_forces = {force};
    return reach_of_plan(strong, options).contacts[0];
  };
  EXPECT_EQ(with_force(0.5 * options.highest_torque / lever), Reach::reachable);
  EXPECT_EQ(with_force(1.5 * options.highest_torque / lever), Reach::too_weak);
}

TEST(ArmReach, RefusesOptionsOutOfRange) {
  ReachOptions options;
  options.share = 1.5;
  EXPECT_THROW(static_cast<void>(reach_of_plan({}, options)), InvalidInput);
  options = {};
  options.links.distance = -1;
  EXPECT_THROW(static_cast<void>(reach_of_plan({}, options)), InvalidInput);
}

}  // namespace
}  // namespace palpate::probing
