// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "reduce/strokes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "palpate/haptics/blended_field.h"
#include "palpate/haptics/contact_compliance.h"
#include "sheet_model.h"

namespace palpate::haptics {
namespace {

using ::testing::HasSubstr;

// The tool of a sheet presses along z, and the surface is at z = 700.
double depth(const Stroke& stroke) { return stroke.pressed.z() - 700; }

TEST(RandomStrokes, PressUpToTheLargestForceAndNotFurther) {
  const Model model = sheet_model();  // forces of 4 d / sqrt(d^2 + 100) N
  constexpr double kForce = 1.5;
  const double deepest = 10 * kForce / std::sqrt(16 - kForce * kForce);
  double largest = 0;
  for (const Stroke& stroke :
       random_strokes(model, {.count = 500, .largest_force = kForce, .drags = false})) {
    EXPECT_GT(depth(stroke), 0);
    EXPECT_EQ(stroke.dragged, stroke.pressed);
    largest = std::max(largest, depth(stroke));
  }
  EXPECT_LE(largest, deepest);
  EXPECT_GT(largest, 0.98 * deepest);  // of 500 even depths, one is this deep: 1 - 0.98^500
}

TEST(RandomStrokes, EndWhereTheModelIsInContactAndCanBeReached) {
  const Model model = sheet_model();
  StrokeSettings settings{.count = 300, .largest_depth = 3};
  for (const auto& vertex : model.surface.vertices.colwise())
    settings.reachable.push_back(vertex.x() < 5);
  const std::vector<Stroke> strokes = random_strokes(model, settings);
  EXPECT_GT(strokes.size(), 250U);
  const std::vector<StrokeEnd> ends = play_strokes(model, strokes);
  EXPECT_EQ(ends.size(), 2 * strokes.size());
  for (const StrokeEnd& end : ends) {
    EXPECT_TRUE(end.touches);
    EXPECT_LT(end.contact.x(), 5);
  }
}

TEST(RandomStrokes, CoverAllAreasAlike) {
  int left = 0, near = 0;
  const std::vector<Stroke> strokes =
      random_strokes(sheet_model(), {.count = 2000, .largest_depth = 3, .drags = false});
  for (const Stroke& stroke : strokes) {
    left += stroke.pressed.x() < 0;
    near += stroke.pressed.y() < -25;
  }
  const auto all = static_cast<double>(strokes.size());
  EXPECT_NEAR(left / all, 0.5, 0.04);  // four standard errors
  EXPECT_NEAR(near / all, 0.25, 0.04);
}

// Friction on the right half holds any drag; on the left one, none. Between, a tool holds or slips.
TEST(RandomStrokes, AreNotWhereTheModelItselfJumps) {
  Model model = sheet_model();
  for (ContactModel& contact : model.contacts)
    contact.friction = contact.position.x() > 0 ? 3 : 0.01;
  const std::vector<Stroke> strokes = random_strokes(model, {.count = 1000, .largest_depth = 3});
  std::vector<Stroke> beside = strokes;
  for (Stroke& stroke : beside) {
    for (Eigen::Vector3d* position : {&stroke.start, &stroke.pressed, &stroke.dragged})
      position->x() += 0.005;
  }
  const std::vector<double> changes =
      force_differences(play_strokes(model, strokes), play_strokes(model, beside));
  EXPECT_LT(std::ranges::max(changes), 0.2);  // [N] of forces of up to 1.7 N
}

TEST(RandomStrokes, AreTheSameForTheSameSeed) {
  const Model model = sheet_model();
  const StrokeSettings settings{.count = 50, .seed = 3, .largest_depth = 3};
  StrokeSettings other = settings;
  other.seed = 1000;
  const auto tools = [&](const StrokeSettings& of) {
    std::vector<double> result;
    for (const StrokeEnd& end : play_strokes(model, random_strokes(model, of)))
      result.insert(result.end(), end.tool.begin(), end.tool.end());
    return result;
  };
  EXPECT_EQ(tools(settings), tools(settings));
  EXPECT_NE(tools(settings), tools(other));
}

TEST(RandomStrokes, RefuseWhatNoToolCanDo) {
  const Model model = sheet_model();
  const std::vector<bool> nowhere(static_cast<std::size_t>(model.surface.vertices.cols()), false);
  EXPECT_THAT(refusal([&] {
                return random_strokes(model,
                                      {.count = 9, .reachable = nowhere, .largest_depth = 3});
              }),
              HasSubstr("contains no whole triangle"));
  EXPECT_THAT(refusal([&] { return random_strokes(model, {.count = 9}); }),
              HasSubstr("does not say how far it was measured"));
  EXPECT_FALSE(random_strokes(with_compliances(model, 1), {.count = 9}).empty());
}

TEST(PressDepths, AreThoseOfTheLargestForce) {
  const Model model = sheet_model();
  for (const double depth : press_depths(model, {.largest_force = 2}))
    EXPECT_NEAR(depth, 10 * 2 / std::sqrt(16.0 - 4), 0.01);
}

}  // namespace
}  // namespace palpate::haptics
