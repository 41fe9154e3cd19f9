// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/contact_equilibrium.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <thread>

#include "palpate/core/error.h"
#include "random_paths.h"

namespace palpate::probing {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using ::testing::HasSubstr;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<double> even(double from, double to, int cells) {
  std::vector<double> result;
  for (int i = 0; i <= cells; ++i) result.push_back(from + (to - from) * i / cells);
  return result;
}

template <typename Condition>
void support_where(DeformableBody& body, const Condition& condition) {
  for (int n = 0; n < body.mesh.nodes.cols(); ++n)
    if (condition(Vector3d(body.mesh.nodes.col(n)))) body.supported.push_back(n);
}

// A block of 40 x 40 x 16 mm on a table; z points down, and the tip comes from above.
DeformableBody soft_block(int cells = 4, int layers = 2) {
  DeformableBody body;
  body.mesh = box_mesh(even(-20, 20, cells), even(-20, 20, cells), even(0, 16, layers));
  body.materials = {{.shear_modulus = 0.05, .bulk_modulus = 0.5}};
  support_where(body, [](const Vector3d& at) { return at.z() > 16 - 1e-9; });
  return body;
}

const Vector3d kDown = Vector3d::UnitZ();
const Vector3d kPlace(1.5, -2, 0);

// All nodes of the boundary are moved by one affine map.
DeformableBody affine_box(const Matrix3d& gradient, const Hyperelastic& material) {
  DeformableBody body;
  body.mesh = box_mesh({0, 2, 3, 6}, {0, 1, 4}, {0, 2, 5});
  // Inner corners are moved, and the middles of their edges with them.
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-0.3, 0.3);
  std::vector<bool> boundary(static_cast<std::size_t>(body.mesh.nodes.cols()), false);
  for (const BoundaryFace& face : boundary_faces(body.mesh))
    for (const int node : face.nodes) boundary[static_cast<std::size_t>(node)] = true;
  std::vector<bool> corner(boundary.size(), false);
  for (const int node : body.mesh.elements.topRows<4>().reshaped())
    corner[static_cast<std::size_t>(node)] = true;
  for (std::size_t n = 0; n < corner.size(); ++n) {
    if (!corner[n] || boundary[n]) continue;
    for (double& x : body.mesh.nodes.col(static_cast<Eigen::Index>(n))) x += uniform(random);
  }
  constexpr int kEdges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
  for (auto element : body.mesh.elements.colwise())
    for (int e = 0; e < 6; ++e)
      body.mesh.nodes.col(element[4 + e]) = (body.mesh.nodes.col(element[kEdges[e][0]]) +
                                             body.mesh.nodes.col(element[kEdges[e][1]])) /
                                            2;
  body.materials = {material};
  for (std::size_t n = 0; n < boundary.size(); ++n)
    if (boundary[n]) body.supported.push_back(static_cast<int>(n));
  body.support_moves.resize(3, static_cast<Eigen::Index>(body.supported.size()));
  for (std::size_t k = 0; k < body.supported.size(); ++k)
    body.support_moves.col(static_cast<Eigen::Index>(k)) =
        (gradient - Matrix3d::Identity()) * body.mesh.nodes.col(body.supported[k]);
  return body;
}

TEST(ContactEquilibrium, PassesThePatchTest) {
  const Matrix3d gradient{{1.2, 0.3, 0}, {-0.1, 0.9, 0.2}, {0.05, 0, 1.1}};
  const ContactEquilibrium solid(affine_box(gradient, {.bulk_modulus = 2, .mooney_share = 0.4}));
  EXPECT_LT((solid.rest() - gradient * solid.body().mesh.nodes).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(ContactEquilibrium, SimpleShearHasItsEnergyInClosedForm) {
  Matrix3d gradient = Matrix3d::Identity();
  gradient(0, 2) = 0.6;
  // I1 - 3 and I2 - 3 are both the square of the shear, and the volume is constant.
  for (const double share : {0.0, 0.35}) {
    const Hyperelastic material{.shear_modulus = 0.3, .bulk_modulus = 30, .mooney_share = share};
    const ContactEquilibrium solid(affine_box(gradient, material));
    const double exact = 0.3 / 2 * 0.36 * (6 * 4 * 5);
    EXPECT_NEAR(solid.elastic_energy(solid.rest()), exact, 1e-9 * exact);
  }
}

// A bar of 3 x 3 x 15 mm whose ends are pulled apart.
ContactEquilibrium pulled_bar(double longer, const Hyperelastic& material) {
  DeformableBody body;
  body.mesh = box_mesh(even(0, 3, 2), even(0, 3, 2), even(0, 15, 8));
  body.materials = {material};
  support_where(body, [](const Vector3d& at) { return at.z() < 1e-9 || at.z() > 15 - 1e-9; });
  body.support_moves.setZero(3, static_cast<Eigen::Index>(body.supported.size()));
  for (std::size_t k = 0; k < body.supported.size(); ++k)
    if (body.mesh.nodes(2, body.supported[k]) > 7)
      body.support_moves(2, static_cast<Eigen::Index>(k)) = longer;
  return ContactEquilibrium(std::move(body), {.tip_radius = 2});
}

TEST(ContactEquilibrium, ABarIsPulledAsInClosedForm) {
  const Hyperelastic material{.shear_modulus = 0.3, .bulk_modulus = 300, .mooney_share = 0.25};
  constexpr double kLonger = 6, kStep = 0.01;
  const ContactEquilibrium bar = pulled_bar(kLonger, material);
  const ContactEquilibrium more = pulled_bar(kLonger + kStep, material);
  const ContactEquilibrium less = pulled_bar(kLonger - kStep, material);
  const double force =
      (more.elastic_energy(more.rest()) - less.elastic_energy(less.rest())) / (2 * kStep);
  // The stretch of the middle, far from the ends.
  double low = 0, high = 0;
  for (int n = 0; n < bar.rest().cols(); ++n) {
    const Vector3d at = bar.body().mesh.nodes.col(n);
    if (at.head<2>() != Eigen::Vector2d(1.5, 1.5)) continue;
    if (at.z() == 15.0 * 3 / 8) low = bar.rest()(2, n);
    if (at.z() == 15.0 * 5 / 8) high = bar.rest()(2, n);
  }
  const double stretch = (high - low) / (15.0 / 4);
  EXPECT_GT(stretch, 1.35);
  // Incompressible Mooney-Rivlin: 2 (c10 + c01 / stretch) (stretch - stretch^-2).
  const double c10 = 0.75 * 0.3 / 2, c01 = 0.25 * 0.3 / 2;
  const double exact = 9 * 2 * (c10 + c01 / stretch) * (stretch - 1 / (stretch * stretch));
  EXPECT_NEAR(force, exact, 1e-3 * exact);
}

TEST(ContactEquilibrium, TheTipCarriesTheForce) {
  const ContactEquilibrium solid(soft_block());
  const ContactState start = solid.touch(kPlace, kDown);
  EXPECT_NEAR(start.tip.z(), -5, 0.01);
  EXPECT_EQ(start.tip.head<2>(), kPlace.head<2>());
  const Vector3d force(0.3, -0.2, 1);
  const ContactResult result = solid.apply_force(start, force);
  ASSERT_EQ(result.stop, ContactStop::converged);
  EXPECT_LT((result.state.force - force).norm(), 1e-5);
  EXPECT_GT(result.state.tip.z() - start.tip.z(), 0.5);
  // The same equilibrium by position, and with the exact matrix in each iteration.
  const ContactResult moved = solid.move_tip(start, result.state.tip);
  ASSERT_EQ(moved.stop, ContactStop::converged);
  EXPECT_LT((moved.state.force - force).norm(), 1e-4);
  const ContactEquilibrium exact(soft_block(), {.exact_tangent = true});
  EXPECT_LT((exact.apply_force(start, force).state.tip - result.state.tip).norm(), 1e-4);
}

TEST(ContactEquilibrium, IsTheSameWhereverTheObjectIs) {
  // Far away, rounding decides whether the point that the tip touches first is inside it.
  const Vector3d force(0, 0.4, 1.1), place(1, 2, 0);
  const auto depth = [&](const Vector3d& away) {
    DeformableBody body = soft_block();
    body.mesh.nodes.colwise() += away;
    const ContactEquilibrium solid(std::move(body));
    const ContactState start = solid.touch(place + away, kDown);
    const ContactResult result = solid.apply_force(start, force);
    EXPECT_EQ(result.stop, ContactStop::converged) << away.transpose();
    return Vector3d(result.state.tip - start.tip);
  };
  const Vector3d here = depth(Vector3d::Zero());
  for (const Vector3d& away : {Vector3d(0, 0, 700), Vector3d(0, 0, -700), Vector3d(300, -200, 650)})
    EXPECT_LT((depth(away) - here).norm(), 1e-5) << away.transpose();
}

TEST(ContactEquilibrium, OneLoadStepIsNearlyManySteps) {
  const ContactState start = ContactEquilibrium(soft_block()).touch(kPlace, kDown);
  const Vector3d force(0.5, 0, 1.5);
  const auto tip = [&](int steps) {
    return Vector3d(ContactEquilibrium(soft_block(), {.load_steps = steps})
                        .apply_force(start, force)
                        .state.tip -
                    start.tip);
  };
  const Vector3d many = tip(16);
  EXPECT_LT((tip(1) - many).norm(), 0.02 * many.norm());
  EXPECT_LT((tip(4) - many).norm(), 0.01 * many.norm());
}

// Derivatives of the tip's position by the force, at a state.
Matrix3d compliance(const ContactEquilibrium& solid, const ContactState& at) {
  constexpr double kStep = 1e-4;  // [N]
  Matrix3d result;
  for (int k = 0; k < 3; ++k) {
    const Vector3d d = kStep * Vector3d::Unit(k);
    result.col(k) = (solid.apply_force(at, at.force + d).state.tip -
                     solid.apply_force(at, at.force - d).state.tip) /
                    (2 * kStep);
  }
  return result;
}

TEST(ContactEquilibrium, DisplacementsAreReciprocalWhileTheTipSticks) {
  const ContactEquilibrium solid(soft_block(), {.tolerance = 1e-12});
  const ContactResult pressed =
      solid.apply_force(solid.touch(kPlace, kDown), Vector3d(0.2, 0.1, 0.8));
  ASSERT_EQ(pressed.stop, ContactStop::converged);
  const Matrix3d c = compliance(solid, pressed.state);
  EXPECT_LT((c - c.transpose()).norm(), 1e-6 * c.norm());
  EXPECT_GT(std::abs(c(0, 2)), 1e-3 * c(2, 2));  // not symmetric by the symmetry of the object
}

TEST(ContactEquilibrium, AStickingTipGivesNoEnergyAndTakesNone) {
  // Points at the edge come and go in larger circles, and lose the energy of their springs.
  constexpr double kAcross = 0.05;  // [N]
  const ContactEquilibrium solid(soft_block(), {.tolerance = 1e-9});
  const ContactResult pressed =
      solid.apply_force(solid.touch(kPlace, kDown), Vector3d(kAcross, 0, 1.2));
  ASSERT_EQ(pressed.stop, ContactStop::converged);
  ContactState at = pressed.state;
  double work = 0, size = 0;
  constexpr int kParts = 24;
  for (int i = 1; i <= kParts; ++i) {
    const double angle = 2 * std::numbers::pi * i / kParts;
    const ContactResult next =
        solid.apply_force(at, Vector3d(kAcross * std::cos(angle), kAcross * std::sin(angle), 1.2));
    ASSERT_EQ(next.stop, ContactStop::converged);
    const double part = (at.force + next.state.force).dot(next.state.tip - at.tip) / 2;
    work += part;
    size += std::abs(part);
    at = next.state;
  }
  EXPECT_LT(std::abs(work), 1e-4 * size);
  EXPECT_GT(size, 1e-4);
}

TEST(ContactEquilibrium, SlippingTakesEnergyAndSlidingIsNamed) {
  const ContactEquilibrium solid(soft_block(), {.friction = 0.5});
  const ContactState start = solid.touch({0, 0, 0}, kDown);
  const ContactResult pressed = solid.apply_force(start, Vector3d(0, 0, 1));
  const ContactResult dragged = solid.apply_force(pressed.state, Vector3d(0.35, 0, 1));
  ASSERT_EQ(dragged.stop, ContactStop::converged);
  EXPECT_GT(dragged.slipping, 0);
  EXPECT_LT(dragged.slipping, dragged.points);
  const ContactResult back = solid.apply_force(dragged.state, Vector3d(0, 0, 1));
  ASSERT_EQ(back.stop, ContactStop::converged);
  EXPECT_GT(back.state.tip.x() - pressed.state.tip.x(), 1e-3);  // microslip stays
  const ContactResult slid = solid.apply_force(pressed.state, Vector3d(1.5, 0, 1));
  EXPECT_NE(slid.stop, ContactStop::converged);
  EXPECT_LT(slid.state.force.x(), 1);
}

TEST(ContactEquilibrium, AFinerMeshConverges) {
  const auto depth = [&](int cells, int layers) {
    const ContactEquilibrium solid(soft_block(cells, layers));
    const ContactState start = solid.touch({0, 0, 0}, kDown);
    return solid.apply_force(start, Vector3d(0, 0, 1)).state.tip.z() - start.tip.z();
  };
  const double coarse = depth(2, 1), middle = depth(4, 2), fine = depth(8, 4);
  EXPECT_LT(std::abs(fine - middle), std::abs(middle - coarse));
  EXPECT_NEAR(fine, middle, 0.15 * fine);
}

TEST(ContactEquilibrium, ABlockBelowStopsASheet) {
  DeformableBody sheet;
  sheet.mesh = box_mesh(even(-24, 24, 6), even(-16, 16, 4), even(0, 2, 1));
  sheet.materials = {{.shear_modulus = 0.3, .bulk_modulus = 6}};
  support_where(sheet, [](const Vector3d& at) { return std::abs(at.x()) > 24 - 1e-9; });
  sheet.support_moves.setZero(3, static_cast<Eigen::Index>(sheet.supported.size()));
  for (std::size_t k = 0; k < sheet.supported.size(); ++k)
    sheet.support_moves(0, static_cast<Eigen::Index>(k)) =
        std::copysign(2.4, sheet.mesh.nodes(0, sheet.supported[k]));
  const ContactEquilibrium free(sheet);
  // Pre-stretch by a tenth thins the middle of the nearly incompressible sheet.
  double top = 0, bottom = 0;
  for (int n = 0; n < free.rest().cols(); ++n) {
    if (sheet.mesh.nodes.col(n) == Vector3d(0, 0, 0)) top = free.rest()(2, n);
    if (sheet.mesh.nodes.col(n) == Vector3d(0, 0, 2)) bottom = free.rest()(2, n);
  }
  EXPECT_GT(bottom - top, 2 / 1.1);
  EXPECT_LT(bottom - top, 2 / 1.03);
  sheet.obstacles = {{{-8, -8, 5}, {8, 8, 15}}};
  const ContactEquilibrium stopped(sheet);
  const auto depth = [](const ContactEquilibrium& solid, double force) {
    const ContactState start = solid.touch({0, 0, 0.1}, kDown);
    const ContactResult result = solid.apply_force(start, Vector3d(0, 0, force));
    EXPECT_EQ(result.stop, ContactStop::converged) << to_string(result.stop);
    return result.state.tip.z() - start.tip.z();
  };
  EXPECT_NEAR(depth(free, 0.3), depth(stopped, 0.3), 1e-5);
  EXPECT_GT(depth(free, 3), 4.5);
  EXPECT_LT(depth(stopped, 3), 0.9 * depth(free, 3));
}

TEST(ContactEquilibrium, GivesTheSameFromAnyThreadAndInAnyOrder) {
  const ContactEquilibrium solid(soft_block());
  const Vector3d places[2] = {kPlace, {-9, 8, 0}}, force(0.2, 0, 0.9);
  const auto tip = [&](const ContactEquilibrium& of, const Vector3d& place) {
    return of.apply_force(of.touch(place, kDown), force).state.tip;
  };
  Vector3d found[2];
  {
    std::jthread first([&] { found[0] = tip(solid, places[0]); });
    std::jthread second([&] { found[1] = tip(solid, places[1]); });
  }
  const ContactEquilibrium other(soft_block());
  EXPECT_EQ(tip(other, places[1]), found[1]);
  EXPECT_EQ(tip(other, places[0]), found[0]);
  EXPECT_EQ(tip(solid, places[1]), found[1]);
}

TEST(ContactSeries, FindsWhatTheSolidFindsOneByOne) {
  const ContactEquilibrium solid(soft_block());
  const ContactState start = solid.touch(kPlace, kDown);
  const std::vector<Vector3d> forces = {{0, 0, 0.2},      {0.1, 0, 0.2},    {0, 0, 1.5},
                                        {0.6, -0.7, 1.5}, {-0.9, 0.2, 1.5}, {0, 0.1, 0.3}};
  ContactSeries series(solid, start), again(solid, start);
  for (const Vector3d& force : forces) {
    const ContactResult found = series.apply_force(force);
    ASSERT_EQ(found.stop, ContactStop::converged) << force.transpose();
    const ContactResult alone = solid.apply_force(start, force);
    EXPECT_LT((found.state.tip - alone.state.tip).norm(), 1e-4) << force.transpose();
    EXPECT_LT((found.state.force - force).norm(), 1e-5);
    EXPECT_EQ(again.apply_force(force).state.tip, found.state.tip);
  }
}

TEST(ContactSeries, GoesOnAfterAForceWithoutEquilibrium) {
  const ContactEquilibrium solid(soft_block(6), {.max_halvings = 1});
  const ContactState start = solid.touch(kPlace, kDown);
  ContactSeries series(solid, start);
  // Under it the tip touches more of the surface than was expected.
  const ContactResult large = series.apply_force(Vector3d(2, 0, 3));
  EXPECT_EQ(large.stop, ContactStop::converged);
  EXPECT_GT(large.factorisations, 0);
  EXPECT_EQ(series.apply_force(Vector3d(0, 0, -1)).stop, ContactStop::contact_lost);
  EXPECT_EQ(series.apply_force(Vector3d::Zero()).stop, ContactStop::converged);
  EXPECT_NE(series.apply_force(Vector3d(0, 0, 1e4)).stop, ContactStop::converged);
  EXPECT_THROW((void)series.apply_force(Vector3d(0, 0, std::nan(""))), InvalidInput);
  const Vector3d force(0.2, 0.1, 0.7);
  EXPECT_LT(
      (series.apply_force(force).state.tip - solid.apply_force(start, force).state.tip).norm(),
      1e-4);
}

TEST(ContactEquilibrium, FailsByName) {
  const ContactEquilibrium solid(soft_block(), {.max_halvings = 1});
  const ContactState start = solid.touch(kPlace, kDown);
  EXPECT_EQ(solid.apply_force(start, Vector3d(0, 0, -1)).stop, ContactStop::contact_lost);
  EXPECT_EQ(solid.apply_force(start, Vector3d::Zero()).stop, ContactStop::converged);
  const ContactResult crushed = solid.apply_force(start, Vector3d(0, 0, 1e4));
  EXPECT_NE(crushed.stop, ContactStop::converged);
  EXPECT_THROW((void)solid.apply_force(start, Vector3d(0, 0, std::nan(""))), InvalidInput);
  EXPECT_THROW((void)solid.touch({100, 0, 0}, kDown), InvalidInput);
  EXPECT_THROW((void)solid.touch({0, 0, 16}, kDown), InvalidInput);  // through the object
}

// Many more in `finite_element_validation` in studies.
TEST(ContactEquilibrium, RandomPathsConvergeOrFailByName) {
  palpate::support::PathCounts counts;
  unsigned seed = 0;
  const auto follow = [&](const palpate::support::PathSolid& object, double friction, int paths) {
    const ContactEquilibrium solid(object.body, {.friction = friction});
    for (int i = 0; i < paths; ++i)
      palpate::support::follow_random_path(object, solid, seed++, 2, counts);
  };
  follow(palpate::support::path_block(10, 4, 2), kInfinity, 6);
  follow(palpate::support::path_block(10, 4, 2), 0.6, 6);
  follow(palpate::support::path_sheet(8, 4), kInfinity, 4);
  EXPECT_THAT(counts.broken, ::testing::IsEmpty());
  EXPECT_EQ(counts.paths, 16);
  EXPECT_GE(counts.converged, 8);
  EXPECT_GT(counts.deepest, 8);
}

std::string body_refusal(const DeformableBody& body, const EquilibriumOptions& options = {}) {
  try {
    const ContactEquilibrium solid(body, options);
  } catch (const InvalidInput& e) {
    return e.what();
  }
  return "";
}

TEST(ContactEquilibrium, SaysWhatIsWrongWithTheObject) {
  DeformableBody body = soft_block();
  body.supported.clear();
  EXPECT_THAT(body_refusal(body), HasSubstr("has 0 supported nodes"));
  body = soft_block();
  body.supported.resize(2);
  EXPECT_THAT(body_refusal(body), HasSubstr("three or more that do not lie in a line"));
  body = soft_block();
  body.mesh.regions[5] = 1;
  EXPECT_THAT(body_refusal(body), HasSubstr("element 5 is in region 1"));
  body = soft_block();
  body.materials[0].bulk_modulus = 5000;
  EXPECT_THAT(body_refusal(body), HasSubstr("Hyperelastic::bulk_modulus is 5000"));
  body = soft_block();
  body.obstacles = {{{0, 0, 0}, {1, 1, 1}, 2}};
  EXPECT_THAT(body_refusal(body), HasSubstr("RigidBlock::rounding is 2"));
  EXPECT_THAT(body_refusal(soft_block(), {.tip_radius = 0}), HasSubstr("tip_radius is 0"));
  EXPECT_THAT(body_refusal(soft_block(), {.friction = -kInfinity}), HasSubstr("friction"));
}

}  // namespace
}  // namespace palpate::probing
