// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "finite_elements/contact_sensitivity.h"

#include <gmock/gmock.h>

#include <limits>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/probing/contact_equilibrium.h"
#include "refusal.h"
#include "solid_meshes.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;
using palpate::support::evenly;

const Vector3d kBlockPlace(2, 1, 0), kBlockInward(0, 0, 1), kBlockForce(0.15, -0.1, 0.8);

// A block with a stiff half, whose left and right sides are pulled apart by `stretch` [mm].
DeformableBody half_stiff_block(double soft, double stiff, double bulk_ratio, double stretch) {
  DeformableBody body;
  body.mesh = box_mesh(evenly(-15, 15, 4), evenly(-12, 12, 4), evenly(0, 12, 2));
  for (Eigen::Index e = 0; e < body.mesh.elements.cols(); ++e) {
    const double x = body.mesh.nodes(0, body.mesh.elements(0, e)) +
                     body.mesh.nodes(0, body.mesh.elements(1, e)) +
                     body.mesh.nodes(0, body.mesh.elements(2, e)) +
                     body.mesh.nodes(0, body.mesh.elements(3, e));
    body.mesh.regions[static_cast<std::size_t>(e)] = x > 0 ? 1 : 0;
  }
  body.materials = {{.shear_modulus = soft, .bulk_modulus = bulk_ratio * soft},
                    {.shear_modulus = stiff, .bulk_modulus = bulk_ratio * stiff}};
  palpate::support::support_where(
      body, [](const Vector3d& at) { return std::abs(at.x()) == 15 || at.z() == 12; });
  palpate::support::move_supports(body, [&](const Vector3d& at) -> Vector3d {
    return {stretch * at.x() / 15, 0, 0};
  });
  return body;
}

struct BlockSettings {
  double soft = 0.03, stiff = 0.12, bulk_ratio = 8, stretch = 1.5;
  [[nodiscard]] BlockSettings with(int k, double change) const {
    BlockSettings result = *this;
    double* const values[4] = {&result.soft, &result.stiff, &result.bulk_ratio, &result.stretch};
    *values[k] += change;
    return result;
  }
  [[nodiscard]] ContactEquilibrium solid(double friction) const {
    return ContactEquilibrium(half_stiff_block(soft, stiff, bulk_ratio, stretch),
                              {.tip_radius = 4, .friction = friction, .tolerance = 1e-9});
  }
};

Vector3d tip_way(const ContactEquilibrium& solid, const Vector3d& force) {
  const ContactState from = solid.touch(kBlockPlace, kBlockInward);
  const ContactResult found = solid.apply_force(from, force);
  EXPECT_EQ(found.stop, ContactStop::converged);
  return found.state.tip - from.tip;
}

TEST(ContactSensitivity, AgreesWithEquilibriaOfChangedSolidsAndForces) {
  const BlockSettings given;
  const std::vector<double> steps{1e-3, 4e-3, 0.3, 0.05};
  for (const double friction : {std::numeric_limits<double>::infinity(), 0.5}) {
    const Vector3d& force = kBlockForce;
    const ContactEquilibrium solid = given.solid(friction);
    ContactSeries series(solid, solid.touch(kBlockPlace, kBlockInward));
    const ContactResult found = series.apply_force(force);
    ASSERT_EQ(found.stop, ContactStop::converged);
    std::vector<ContactEquilibrium> solids;
    for (int k = 0; k < 4; ++k)
      for (const double sign : {-1.0, 1.0})
        solids.push_back(
            given.with(k, sign * 1e-3 * steps[static_cast<std::size_t>(k)]).solid(friction));
    std::vector<SolidChange> changes;
    for (std::size_t k = 0; k < 4; ++k)
      changes.push_back({&solids[2 * k], &solids[2 * k + 1],
                         solids[2 * k].touch(kBlockPlace, kBlockInward),
                         solids[2 * k + 1].touch(kBlockPlace, kBlockInward), 2e-3 * steps[k]});
    const TipSensitivity sensitivity = series.sensitivity(found.state, changes);
    for (int k = 0; k < 4; ++k) {
      const double step = steps[static_cast<std::size_t>(k)];
      const Vector3d difference = (tip_way(given.with(k, step).solid(friction), force) -
                                   tip_way(given.with(k, -step).solid(friction), force)) /
                                  (2 * step);
      EXPECT_LT((sensitivity.by_changes.col(k) - difference).norm(), 0.02 * difference.norm())
          << "parameter " << k << ", friction " << friction << ": "
          << sensitivity.by_changes.col(k).transpose() << " and " << difference.transpose();
    }
    constexpr double kStep = 2e-3;  // [N]
    for (int i = 0; i < 3; ++i) {
      const Vector3d change = kStep * Vector3d::Unit(i);
      const Vector3d difference =
          (tip_way(solid, force + change) - tip_way(solid, force - change)) / (2 * kStep);
      EXPECT_LT((sensitivity.compliance.col(i) - difference).norm(), 0.02 * difference.norm())
          << "force " << i << ", friction " << friction;
    }
  }
}

TEST(ContactSensitivity, DoublingAllModuliActsAsHalvingTheForce) {
  const BlockSettings given;
  const ContactEquilibrium solid = given.solid(std::numeric_limits<double>::infinity());
  ContactSeries series(solid, solid.touch(kBlockPlace, kBlockInward));
  const ContactResult found = series.apply_force(kBlockForce);
  const auto scaled = [&](double factor) {
    BlockSettings result = given;
    result.soft *= factor;
    result.stiff *= factor;
    return result.solid(std::numeric_limits<double>::infinity());
  };
  constexpr double kStep = 1e-4;
  const ContactEquilibrium less = scaled(1 - kStep), more = scaled(1 + kStep);
  const std::vector<SolidChange> changes{{&less, &more, less.touch(kBlockPlace, kBlockInward),
                                          more.touch(kBlockPlace, kBlockInward), 2 * kStep}};
  const TipSensitivity sensitivity = series.sensitivity(found.state, changes);
  // d(s mu, f) = d(mu, f / s), thus dd/ds = -(dd/df) f.
  const Vector3d expected = -sensitivity.compliance * kBlockForce;
  EXPECT_LT((sensitivity.by_changes.col(0) - expected).norm(), 3e-3 * expected.norm());
}

TEST(ContactSensitivity, RefusesASolidOfOtherNodes) {
  const ContactEquilibrium solid = BlockSettings{}.solid(0);
  DeformableBody other;
  other.mesh = box_mesh(evenly(-15, 15, 2), evenly(-12, 12, 2), evenly(0, 12, 2));
  other.materials = {{}};
  palpate::support::support_where(other, [](const Vector3d& at) { return at.z() == 12; });
  const ContactEquilibrium wrong(std::move(other), {.tip_radius = 4});
  ContactSeries series(solid, solid.touch(kBlockPlace, kBlockInward));
  const ContactState at = series.apply_force({0, 0, 0.5}).state;
  const std::vector<SolidChange> changes{{&wrong, &wrong, wrong.touch(kBlockPlace, kBlockInward),
                                          wrong.touch(kBlockPlace, kBlockInward), 1}};
  EXPECT_THAT(refusal([&] { return series.sensitivity(at, changes); }),
              ::testing::HasSubstr("other nodes"));
}

}  // namespace
}  // namespace palpate::probing
