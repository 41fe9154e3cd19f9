// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/core/field_text.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <optional>
#include <string>

#include "palpate/core/error.h"

namespace palpate {
namespace {

enum class Side { left, right };
constexpr std::array<std::string_view, 2> kSides{"left", "right"};
constexpr std::array<TableField::Column, 2> kPlaces{{{"x", finite()}, {"y", finite()}}};

struct GripOptions {
  double width = 0.1;
  double limit = std::numeric_limits<double>::infinity();
  int fingers = 3;
  bool is_soft = false;
  Side side = Side::left;
  std::optional<double> torque = std::nullopt;
  std::optional<int> joints = std::nullopt;
  TableField::Rows places = {};

  bool operator==(const GripOptions&) const = default;
};

void visit(GripOptions& options, FieldVisitor& visitor) {
  visitor.begin("GripOptions");
  visitor.real({"width", "Width of the grip", "mm"}, options.width, above(0));
  visitor.real({"limit", "Largest force", "N"}, options.limit, at_least(0));
  visitor.whole({"fingers", "Number of fingers"}, options.fingers, at_least(1).at_most(5));
  visitor.flag({"is_soft", "The fingers bend"}, options.is_soft);
  visitor.choice({"side", "Side of the hand"}, options.side, kSides);
  visitor.real({"torque", "Largest torque", "N mm"}, options.torque, above(0));
  visitor.whole({"joints", "Number of joints"}, options.joints, at_least(1));
  visitor.table({"places", "Where it grips"},
                {options.places, kPlaces, [&](const auto& rows) { options.places = rows; }});
}

TEST(FieldText, ComesBackToTheLastBit) {
  GripOptions options{.width = 1.0 / 3,
                      .limit = 7.1e-200,
                      .fingers = 5,
                      .is_soft = true,
                      .side = Side::right,
                      .torque = 12.5,
                      .joints = 4,
                      .places = {{0.1, -2e-9}, {1.0 / 7, 1e30}}};
  GripOptions again;
  for (const FieldText& field : texts_of(fields_of(options)))
    assign(fields_of(again), field.name, field.text);
  EXPECT_EQ(again, options);

  GripOptions usual, usual_again{.limit = 1, .torque = 2};
  for (const FieldText& field : texts_of(fields_of(usual)))
    assign(fields_of(usual_again), field.name, field.text);
  EXPECT_EQ(usual_again, usual);
}

std::string refusal(const char* words) {
  GripOptions options;
  try {
    assign_words(fields_of(options), words);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return {};
}

TEST(FieldText, OfWordsSetsTheirFieldsAlone) {
  GripOptions options;
  assign_words(fields_of(options), "  width=2  side=right ");
  EXPECT_EQ(options, (GripOptions{.width = 2, .side = Side::right}));
  EXPECT_EQ(refusal(""), "");
}

TEST(FieldText, RefusesWithWhatWouldBeRight) {
  EXPECT_EQ(refusal("width=0"), "GripOptions::width is \"0\"; it must be a number > 0");
  EXPECT_EQ(refusal("width=2mm"), "GripOptions::width is \"2mm\"; it must be a number > 0");
  EXPECT_EQ(refusal("width=nan"), "GripOptions::width is \"nan\"; it must be a number > 0");
  EXPECT_EQ(refusal("fingers=2.5"),
            "GripOptions::fingers is \"2.5\"; it must be a whole number in [1, 5]");
  EXPECT_EQ(refusal("is_soft=1"), "GripOptions::is_soft is \"1\"; it must be true or false");
  EXPECT_EQ(refusal("side=top"), "GripOptions::side is \"top\"; it must be left or right");
  EXPECT_NE(refusal("places=1,2,3").find("rows of 2 numbers"), std::string::npos);
  EXPECT_EQ(
      refusal("wide=1"),
      "GripOptions has no field \"wide\"; its fields are width, limit, fingers, is_soft, side, "
      "torque, joints, places");
  EXPECT_NE(refusal("width").find("must be NAME=VALUE"), std::string::npos);
}

}  // namespace
}  // namespace palpate
