// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/surface_response.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "following_surface.h"
#include "not_finite.h"
#include "palpate/haptics/scale_model.h"
#include "refusal.h"

namespace palpate::haptics {
namespace {

using ::testing::HasSubstr;

TEST(SurfaceResponse, MustFitTheModel) {
  const FollowingSheet sheet;
  const SurfaceResponse right = sheet.fit({.nodes = 30});
  const auto refused = [&](const SurfaceResponse& response) {
    Model model = sheet.model;
    model.response = response;
    return refusal([&] {
      check_model(model);
      return 0;
    });
  };
  SurfaceResponse wrong = right;
  wrong.nodes(1, 3) = 30;
  EXPECT_THAT(refused(wrong), HasSubstr("a node of vertex 3 is 30; there are 30"));
  wrong = right;
  wrong.weights(0, 5) = Eigen::half(2.F);
  EXPECT_THAT(refused(wrong), HasSubstr("weights of vertex 5"));
  wrong.weights(0, 5) = Eigen::half(std::numeric_limits<float>::quiet_NaN());
  EXPECT_THAT(refused(wrong), HasSubstr("weights of vertex 5"));
  wrong = right;
  wrong.responses(17, 2) = Eigen::half(std::numeric_limits<float>::infinity());
  EXPECT_THAT(refused(wrong), HasSubstr("contact 2 is not finite"));
  wrong = right;
  wrong.responses.conservativeResize(Eigen::NoChange, 3);
  EXPECT_THAT(refused(wrong), HasSubstr("responses of 3 contacts; the model has 4"));
  wrong = right;
  wrong.dents.conservativeResize(Eigen::NoChange, 3);
  EXPECT_THAT(refused(wrong), HasSubstr("dents of 3 contacts"));
  wrong = right;
  wrong.reach = 0;
  EXPECT_THAT(refused(wrong), HasSubstr("reach"));
  wrong = right;
  for (double SurfaceResponse::*error :
       {&SurfaceResponse::rms, &SurfaceResponse::largest, &SurfaceResponse::kept_rms,
        &SurfaceResponse::kept_largest}) {
    wrong.*error = kNaN;
    EXPECT_THAT(refused(wrong), HasSubstr("errors"));
    wrong = right;
  }
  wrong.shape_contacts[5] = 4;
  EXPECT_THAT(refused(wrong), HasSubstr("recorded surface 5 is of contact 4; there are 4"));
  wrong = right;
  wrong.displacements(1, 3) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(refused(wrong), HasSubstr("recorded surface 3 is not finite"));
  wrong = right;
  wrong.moves.conservativeResize(87, Eigen::NoChange);
  EXPECT_THAT(refused(wrong), HasSubstr("12 columns of three numbers a node"));
}

TEST(SurfaceResponse, HasDentsThatAreLinearBetweenTheirPlaces) {
  SurfaceResponse response;
  response.reach = 32;
  response.dents.setZero(SurfaceResponse::kDentPlaces, 1);
  response.dents(0, 0) = Eigen::half(1.F);
  response.dents(1, 0) = Eigen::half(0.5F);
  response.dents(15, 0) = Eigen::half(0.25F);
  EXPECT_EQ(dent_at(response, 0, 0), 1);
  EXPECT_EQ(dent_at(response, 0, 0.5), 0.875);
  EXPECT_EQ(dent_at(response, 0, 2), 0.5);
  EXPECT_EQ(dent_at(response, 0, 31), 0.125);
  EXPECT_EQ(dent_at(response, 0, 32), 0);
  EXPECT_EQ(dent_at(response, 0, kInf), 0);
}

TEST(SurfaceResponse, GrowsWithTheObject) {
  const FollowingSheet sheet;
  Model model = sheet.model;
  model.response = sheet.fit({.nodes = 30});
  const SurfaceResponse larger = *scale_model(model, {.factor = 2}).model.response;
  EXPECT_LT((larger.responses.cast<float>() - model.response->responses.cast<float>())
                .cwiseAbs()
                .maxCoeff(),
            1e-3);
  EXPECT_DOUBLE_EQ(larger.rms, 2 * model.response->rms);
  EXPECT_DOUBLE_EQ(larger.reach, 2 * model.response->reach);
  EXPECT_DOUBLE_EQ(larger.largest, 2 * model.response->largest);
  EXPECT_DOUBLE_EQ(larger.kept_rms, 2 * model.response->kept_rms);
  EXPECT_EQ(larger.displacements, 2 * model.response->displacements);
  // Its dents are round: it says nothing of an object that is stretched along one axis.
  EXPECT_FALSE(scale_model(model, {.factor = 2, .axis = Eigen::Vector3d::UnitX()}).model.response);
}

}  // namespace
}  // namespace palpate::haptics
