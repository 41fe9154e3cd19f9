// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/plan_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <numeric>

#include "palpate/geometry/farthest_points.h"
#include "palpate/haptics/error_forecast.h"
#include "palpate/haptics/model_io.h"
#include "sphere_model.h"

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;

Model planned_ball(int contacts = 60) {
  Model model =
      ball_model([](const Vector3d&) { return true; }, [](int) { return 0.5; }, contacts, 3);
  for (ContactModel& contact : model.contacts)
    contact.uncertainty = ContactUncertainty{.force = 0.01, .between = 0.004};
  return model;
}

/// A ball of which all vertices may be probed, in four minutes each.
class PlanScene : public ::testing::Test {
 protected:
  PlanScene() {
    std::vector<int> all(static_cast<std::size_t>(model.surface.vertices.cols()));
    std::iota(all.begin(), all.end(), 0);
    const geometry::FarthestPoints points =
        geometry::farthest_points(model.surface, all, {.spacing = 1, .count = 300});
    for (const int vertex : points.vertices)
      places.emplace_back(model.surface.vertices.col(vertex));
  }

  [[nodiscard]] ObjectNeeds needs(const ReduceOptions& options,
                                  std::optional<double> arm_time = {}) const {
    ObjectNeeds result{.name = "ball",
                       .model = &model,
                       .options = options,
                       .places = places,
                       .contact_time = kMinutes,
                       .arm_time = arm_time};
    result.options.largest_depth = 4;
    result.options.strokes = kStrokes;
    return result;
  }
  [[nodiscard]] ObjectPlan plan(const ReduceOptions& options,
                                std::optional<double> arm_time = {}) const {
    return plan_scene(std::vector{needs(options, arm_time)}).front();
  }

  static constexpr double kMinutes = 240;
  static constexpr int kStrokes = 1000;
  Model model = planned_ball();
  std::vector<Vector3d> places;
};

TEST_F(PlanScene, TakesTheFewestContactsWithTheAllowedError) {
  const ErrorForecast forecast(model, {.largest_depth = 4, .strokes = kStrokes});
  const double asked = 0.6 * forecast.at_present();
  const ObjectPlan plan = this->plan({.max_error = asked});
  EXPECT_EQ(plan.limit, PlanLimit::force_error);
  EXPECT_EQ(plan.raised, 1);
  const auto count = static_cast<std::size_t>(plan.planned.contacts);
  EXPECT_DOUBLE_EQ(plan.planned.error, forecast.with(std::span(places).first(count)));
  EXPECT_LE(plan.planned.error, asked);
  EXPECT_GT(forecast.with(std::span(places).first(count - 1)), asked);
  EXPECT_DOUBLE_EQ(plan.planned.arm_time, kMinutes * plan.planned.contacts);
  EXPECT_EQ(plan.with_more.contacts, plan.planned.contacts + 15);
  EXPECT_LT(plan.with_more.error, plan.planned.error);
}

TEST_F(PlanScene, LeavesRoomForAReductionIfTheSizeIsLimited) {
  const double asked =
      0.6 * ErrorForecast(model, {.largest_depth = 4, .strokes = kStrokes}).at_present();
  EXPECT_LE(plan({.max_error = asked, .max_size = 1e5}).planned.error, asked / 1.1);
}

TEST_F(PlanScene, RaisesTheErrorIfTheArmHasTooLittleTime) {
  const ObjectPlan plan = this->plan({.max_error = 0.005}, 70.5 * kMinutes);
  EXPECT_EQ(plan.limit, PlanLimit::arm_time);
  EXPECT_EQ(plan.planned.contacts, 70);
  EXPECT_DOUBLE_EQ(plan.raised, plan.planned.error / 0.005);
  EXPECT_FALSE(plan.is_met());
  EXPECT_EQ(this->plan({}, 70.5 * kMinutes).planned.contacts, 70);
}

TEST_F(PlanScene, SaysThatNoNumberOfContactsSuffices) {
  const ObjectPlan plan = this->plan({.max_error = 0.005});  // the contacts' own is 0.01 N
  EXPECT_EQ(plan.limit, PlanLimit::places);
  EXPECT_EQ(plan.planned.contacts, 300);
  EXPECT_NEAR(plan.of_contacts, 0.01, 1e-9);
  EXPECT_GT(plan.raised, 2);
}

TEST_F(PlanScene, KeepsTheContactsIfNothingIsRequired) {
  const ObjectPlan plan = this->plan({});
  EXPECT_EQ(plan.limit, PlanLimit::none);
  EXPECT_EQ(plan.planned.contacts, 60);
  EXPECT_FALSE(plan.asked);
}

TEST_F(PlanScene, SharesTheTimeOfTheArmByRaisingAllErrorsAlike) {
  const double asked =
      0.6 * ErrorForecast(model, {.largest_depth = 4, .strokes = kStrokes}).at_present();
  const std::vector<ObjectNeeds> objects{needs({.max_error = asked}),
                                         needs({.max_error = 1.5 * asked})};
  const std::vector<ObjectPlan> free = plan_scene(objects);
  const double wanted = free[0].planned.arm_time + free[1].planned.arm_time;
  const std::vector<ObjectPlan> plans = plan_scene(objects, 0.7 * wanted);
  const double taken = plans[0].planned.arm_time + plans[1].planned.arm_time;
  EXPECT_LE(taken, 0.7 * wanted);
  EXPECT_GT(taken, 0.65 * wanted);
  EXPECT_EQ(plans[0].limit, PlanLimit::scene_time);
  EXPECT_GT(plans[0].raised, 1.1);
  EXPECT_NEAR(plans[0].raised, plans[1].raised, 0.05 * plans[0].raised);
  EXPECT_EQ(plan_scene(objects, wanted)[0].limit, PlanLimit::force_error);
}

TEST_F(PlanScene, TellsWhichTimeOfTheArmIsTooShort) {
  const double asked =
      0.6 * ErrorForecast(model, {.largest_depth = 4, .strokes = kStrokes}).at_present();
  const std::vector<ObjectNeeds> objects{needs({.max_error = asked}, 10 * kMinutes),
                                         needs({.max_error = asked})};
  const std::vector<ObjectPlan> plans = plan_scene(objects, 60 * kMinutes);
  EXPECT_EQ(plans[0].planned.contacts, 10);
  EXPECT_EQ(plans[0].limit, PlanLimit::arm_time);
  EXPECT_EQ(plans[1].limit, PlanLimit::scene_time);
  EXPECT_LE(plans[1].planned.contacts, 50);
}

TEST_F(PlanScene, DividesTheContactsThatNothingAsksFor) {
  const std::vector<ObjectNeeds> objects{needs({}, 100 * kMinutes), needs({})};  // 100 and 60
  const std::vector<ObjectPlan> plans = plan_scene(objects, 80 * kMinutes);
  EXPECT_NEAR(plans[0].planned.contacts, 50, 1);
  EXPECT_NEAR(plans[1].planned.contacts, 30, 1);
  EXPECT_EQ(plan_scene(objects, 6 * kMinutes)[0].planned.contacts, 3);
}

TEST_F(PlanScene, KnowsWhetherTheModelMeetsTheRequirement) {
  const double error = ErrorForecast(model, {.largest_depth = 4, .strokes = kStrokes}).at_present();
  EXPECT_TRUE(plan({.max_error = 1.01 * error}).is_met());
  EXPECT_FALSE(plan({.max_error = 0.99 * error}).is_met());
  EXPECT_FALSE(plan({.max_error = 1.01 * error, .max_size = 1e5}).is_met());
  EXPECT_FALSE(plan({}).is_met());
}

TEST_F(PlanScene, ForetellsTheSizeOfAModelWithMoreContacts) {
  const ObjectPlan plan = this->plan({}, 240.5 * kMinutes);
  EXPECT_NEAR(plan.planned.size, folder_size(planned_ball(240)),
              0.05 * folder_size(planned_ball(240)));
}

TEST_F(PlanScene, RefusesWhatCannotBe) {
  EXPECT_THAT(refusal([&] { return plan({.max_error = 0.1}, 600); }),
              HasSubstr("object 'ball': arm_time of 0.167 h is too little: three contacts"));
  EXPECT_THAT(refusal([&] { return plan_scene(std::vector{needs({.max_error = 0.1})}, 600); }),
              HasSubstr("arm_time of the scene is 0.167 h, too little: three contacts of each"));
  places.resize(2);
  EXPECT_THAT(refusal([&] { return plan({.max_error = 0.1}); }),
              HasSubstr("there are 2 places for contacts"));
}

}  // namespace
}  // namespace palpate::haptics
