// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/object_shift.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "campaign/campaign_testing.h"
#include "not_finite.h"
#include "palpate/core/error.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

/// A specimen that was moved.
class MovedSpecimen final : public Specimen {
 public:
  MovedSpecimen(std::shared_ptr<const Specimen> specimen, const Vector3d& by)
      : specimen_(std::move(specimen)), by_(by), surface_(specimen_->surface()) {
    surface_.vertices.colwise() += by;
  }
  const geometry::TriangleMesh& surface() const override { return surface_; }
  Vector3d displacement(const Vector3d& contact, const Vector3d& force) const override {
    return specimen_->displacement(contact - by_, force);
  }
  FrictionCone friction_cone(const Vector3d& contact) const override {
    return specimen_->friction_cone(contact - by_);
  }

 private:
  std::shared_ptr<const Specimen> specimen_;
  Vector3d by_;
  geometry::TriangleMesh surface_;
};

const std::shared_ptr<const Specimen> kProbedBody = make_specimen(ElasticBody{});

std::vector<TrialRecord> first_trials(unsigned seed, int count) {
  const CampaignOptions options;
  Campaign campaign(support::small_plan(*kProbedBody), options);
  const auto arm = make_quasi_static_arm(kProbedBody, {.seed = seed});
  return support::perform(campaign, *arm, options, count);
}

TEST(ObjectShift, ReferencesAreFarApartAndOftenTouched) {
  std::vector<TrialRecord> trials;
  const auto touch = [&](long long id, double x, int times) {
    for (int i = 0; i < times; ++i) {
      TrialRecord record;
      record.order.contact = {.id = id, .position = {x, 0, 0}, .normal = {0, 0, 1}};
      record.result.touch = {x, 0, 0.5};
      trials.push_back(record);
    }
  };
  touch(0, 0, 9);
  touch(1, 30, 10);
  touch(2, 100, 1);  // too seldom
  touch(3, 40, 8);
  trials.back().result.touch.setConstant(kNaN);
  const std::vector<ContactTouches> chosen = reference_touches(trials, 2);
  ASSERT_EQ(chosen.size(), 2U);
  EXPECT_EQ(chosen[0].contact.id, 1);
  EXPECT_EQ(chosen[1].contact.id, 0);
  EXPECT_EQ(chosen[1].heights, std::vector<double>(9, 0.5));
  EXPECT_EQ(reference_touches(trials, 9)[2].heights.size(), 7U);
  EXPECT_TRUE(reference_touches({}, 3).empty());
}

TEST(ObjectShift, AnObjectThatStayedIsNotTakenForMovedAndOneThatMovedIsFound) {
  int taken = 0;
  for (unsigned seed = 1; seed <= 30; ++seed) {
    const std::vector<ContactTouches> before = reference_touches(first_trials(seed, 60), 3);
    ASSERT_GE(before.size(), 2U);
    for (const double up : {0.0, 0.35}) {
      // The camera looks along +z: outwards is -z.
      const auto now_there =
          std::make_shared<const MovedSpecimen>(kProbedBody, Vector3d(0, 0, -up));
      const auto arm = make_quasi_static_arm(now_there, {.seed = seed + 1000});
      const auto shifts = object_shift(before, touch_again(*arm, before, 5, {}));
      for (const ObjectShift& shift : shifts) {
        EXPECT_NEAR(shift.shift, up, 4.5 * shift.error);
        EXPECT_LT(shift.error, 0.05);
        EXPECT_EQ(shift.touches, 5);
        if (up > 0) {
          EXPECT_TRUE(has_moved(shift, 0.1)) << shift.shift;
        } else {
          taken += has_moved(shift, 0.1) ? 1 : 0;
        }
      }
    }
  }
  EXPECT_EQ(taken, 0);
}

TEST(ObjectShift, AnObjectThatIsGoneHasMoved) {
  const std::vector<ContactTouches> before = reference_touches(first_trials(1, 20), 3);
  const auto arm =
      make_quasi_static_arm(std::make_shared<const MovedSpecimen>(kProbedBody, Vector3d(0, 0, 30)));
  const std::vector<ContactTouches> now = touch_again(*arm, before, 2, {});
  for (const ObjectShift& shift : object_shift(before, now)) {
    EXPECT_EQ(shift.touches, 0);
    EXPECT_TRUE(has_moved(shift, 100));
  }
  EXPECT_THROW((void)object_shift(before, {}), InvalidInput);
}

TEST(ObjectShift, FewTouchesNeedALargerShift) {
  const Contact contact{.id = 0, .position = {0, 0, 0}, .normal = {0, 0, 1}};
  const std::vector<ContactTouches> before = {{.contact = contact, .heights = {0.0}}},
                                    now = {{.contact = contact, .heights = {0.11}}};
  ProgramOptions options;
  options.position_noise = 0.05;
  const ObjectShift shift = object_shift(before, now, options)[0];
  EXPECT_NEAR(shift.error, 0.05 * std::sqrt(2.0), 1e-12);
  EXPECT_FALSE(has_moved(shift, 0.1));
  options.position_noise = 0.01;
  EXPECT_TRUE(has_moved(object_shift(before, now, options)[0], 0.1));
}

}  // namespace
}  // namespace palpate::probing
