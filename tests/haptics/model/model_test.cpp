// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sheet_model.h"

namespace palpate::haptics {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

template <typename Change>
std::string refused_model(Change&& change) {
  Model model = sheet_model();
  change(model);
  return refusal([&] { check_model(model); });
}

TEST(CheckModel, AcceptsAModel) { EXPECT_NO_THROW(check_model(sheet_model())); }

TEST(CheckModel, NamesWhatIsWrong) {
  EXPECT_THAT(refused_model([](Model& m) { m.contacts.resize(2); }), HasSubstr("at least three"));
  EXPECT_THAT(refused_model([](Model& m) { m.contacts[2].frame(0, 0) = 1.1; }),
              AllOf(HasSubstr("contact 12"), HasSubstr("frame")));
  EXPECT_THAT(refused_model([](Model& m) { m.contacts[2].frame.col(0) *= -1; }),
              AllOf(HasSubstr("contact 12"), HasSubstr("right-handed")));
  EXPECT_THAT(refused_model([](Model& m) { m.contacts[1].friction = -0.1; }),
              AllOf(HasSubstr("contact 11"), HasSubstr(">= 0")));
  EXPECT_THAT(refused_model([](Model& m) { m.contacts[1].friction_lower_bound = -1; }),
              HasSubstr("contact 11 (entry 1): friction_lower_bound is -1; it must be >= 0"));
  EXPECT_THAT(refused_model([](Model& m) {
                m.contacts[1].load_exponent = -0.6;
                m.friction_force = 1;
              }),
              HasSubstr("contact 11 (entry 1): load_exponent is -0.6"));
  EXPECT_THAT(refused_model([](Model& m) { m.contacts[1].load_exponent = -0.1; }),
              AllOf(HasSubstr("friction_force is 0"), HasSubstr("> 0")));
  EXPECT_THAT(refused_model([](Model& m) {
                m.rate = {{0.3, 0}};
              }),
              AllOf(HasSubstr("rate: time is 0"), HasSubstr("> 0")));
  EXPECT_THAT(refused_model([](Model& m) { m.rate.resize(3, {0.3, 1}); }), HasSubstr("3 terms"));
  EXPECT_THAT(refused_model([](Model& m) { m.contacts[1].chi2 = -1; }),
              HasSubstr("contact 11 (entry 1): chi2 is -1; it must be >= 0"));
  EXPECT_THAT(refused_model([](Model& m) { m.contacts[1].friction_axis *= 2; }),
              AllOf(HasSubstr("contact 11"), HasSubstr("unit")));
  EXPECT_THAT(refused_model([](Model& m) {
                m.contacts[3].position.x() = std::numeric_limits<double>::quiet_NaN();
              }),
              HasSubstr("contact 13"));
  EXPECT_THAT(refused_model([](Model& m) { m.contacts[3].field.bases[0].epsilon = 0; }),
              AllOf(HasSubstr("contact 13"), HasSubstr("epsilon")));
  EXPECT_THAT(refused_model([](Model& m) { m.triangles(1, 1) = 4; }), HasSubstr("triangle"));
  EXPECT_THAT(refused_model([](Model& m) { m.triangles.resize(3, 0); }), HasSubstr("triangle"));
  const auto with_weights = [](auto change) {
    return refused_model([&](Model& m) {
      m.surface_weights = geometry::project_weights(m.surface, contact_mesh(m));
      change(m.surface_weights);
    });
  };
  EXPECT_THAT(with_weights([](geometry::SurfaceWeights& w) { w.contacts.resize(3, 2); }),
              AllOf(HasSubstr("2 vertices"), HasSubstr("121")));
  EXPECT_THAT(with_weights([](geometry::SurfaceWeights& w) { w.contacts(1, 7) = 4; }),
              AllOf(HasSubstr("vertex 7"), HasSubstr("contact 4"), HasSubstr("-1 (none) to 3")));
  EXPECT_THAT(with_weights([](geometry::SurfaceWeights& w) { w.weights(0, 8) += 0.1; }),
              AllOf(HasSubstr("vertex 8"), HasSubstr("sum to 1")));
  EXPECT_THAT(with_weights([](geometry::SurfaceWeights& w) {
                w.weights(0, 9) = std::numeric_limits<double>::quiet_NaN();
              }),
              HasSubstr("vertex 9"));
  for (const char* fingerprint : {"", "0123456789abcde", "0123456789ABCDEF", "0123456789abcdefg"}) {
    EXPECT_THAT(refused_model([&](Model& m) { m.samples_fingerprint = fingerprint; }),
                AllOf(HasSubstr("samples_fingerprint"), HasSubstr("16 hexadecimal digits")));
  }
  EXPECT_THAT(refused_model([](Model& m) { m.T_surface_acquisition.linear() *= 2; }),
              HasSubstr("registration"));
  EXPECT_THAT(refused_model([](Model& m) { m.surface.triangles.resize(3, 0); }),
              HasSubstr("surface"));
}

TEST(CheckModel, NamesTheOffsetThatIsOutOfRange) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const auto with_offsets = [](auto change) {
    return refused_model([&](Model& m) { change(m.pressing_offsets.emplace()); });
  };
  using Offsets = PressingOffsets;
  EXPECT_THAT(with_offsets([](Offsets& o) { o.force.y() = kNaN; }),
              HasSubstr("Model::pressing_offsets: force is nan"));
  EXPECT_THAT(with_offsets([](Offsets& o) { o.force_error.z() = -1; }),
              HasSubstr("force_error is -1 N; it must be >= 0"));
  EXPECT_THAT(with_offsets([](Offsets& o) { o.touch = kNaN; }), HasSubstr("touch is nan"));
  EXPECT_THAT(with_offsets([](Offsets& o) { o.touch_error = -1; }), HasSubstr("touch_error is -1"));
  EXPECT_THAT(with_offsets([](Offsets& o) { o.touch_spread = -1; }),
              HasSubstr("touch_spread is -1"));
  EXPECT_THAT(with_offsets([](Offsets& o) { o.height_slope = kNaN; }),
              HasSubstr("height_slope is nan"));
  EXPECT_THAT(with_offsets([](Offsets& o) { o.height_slope_error = -1; }),
              HasSubstr("height_slope_error is -1"));
  EXPECT_THAT(with_offsets([](Offsets& o) { o.hysteresis = 1; }),
              AllOf(HasSubstr("hysteresis is 1"), HasSubstr("< 1")));
  EXPECT_THAT(with_offsets([](Offsets& o) { o.hysteresis_error = -1; }),
              HasSubstr("hysteresis_error is -1"));
}

}  // namespace
}  // namespace palpate::haptics
