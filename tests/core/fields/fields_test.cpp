// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/core/fields.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "palpate/core/error.h"

namespace palpate {
namespace {

enum class Shape { ball, cone };
constexpr std::array<std::string_view, 2> kShapes{"ball", "cone"};
constexpr std::array<TableField::Column, 2> kMarks{{{"x", finite()}, {"depth", above(0)}}};

struct ToolOptions {
  double radius = 2;
  int points = 3;
  bool is_rigid = true;
  Shape shape = Shape::ball;
  std::optional<int> edges = std::nullopt;
  unsigned seed = 1;
  TableField::Rows marks = {};
};

void visit(ToolOptions& options, FieldVisitor& visitor) {
  visitor.begin("ToolOptions");
  visitor.real({"radius", "Radius of the tip", "mm"}, options.radius, above(0).finite());
  visitor.whole({"points", "Number of points"}, options.points, at_least(1));
  visitor.flag({"is_rigid", "The tool does not bend"}, options.is_rigid);
  visitor.choice({"shape", "Shape of the tip"}, options.shape, kShapes);
  visitor.whole({"edges", "Number of edges"}, options.edges, at_least(3));
  visitor.whole({"seed", "Seed of what is random"}, options.seed, at_least(0));
  visitor.table({"marks", "Marks on the tool"},
                {options.marks, kMarks, [&](const auto& rows) { options.marks = rows; }});
}

std::string refusal_of(ToolOptions options) {
  try {
    require_in_range(fields_of(options));
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return {};
}

TEST(Fields, InRangeAreAccepted) {
  EXPECT_EQ(refusal_of({}), "");
  EXPECT_EQ(refusal_of({.radius = 0.1, .points = 1, .edges = 3, .marks = {{-1, 1}, {2, 3}}}), "");
}

TEST(Fields, OutOfRangeAreRefusedByName) {
  EXPECT_EQ(refusal_of({.radius = -1}), "ToolOptions::radius is -1 mm; it must be > 0 and finite");
  EXPECT_EQ(refusal_of({.radius = std::numeric_limits<double>::quiet_NaN()}),
            "ToolOptions::radius is nan mm; it must be > 0 and finite");
  EXPECT_EQ(refusal_of({.points = 0}), "ToolOptions::points is 0; it must be >= 1");
  EXPECT_EQ(refusal_of({.edges = 2}), "ToolOptions::edges is 2; it must be >= 3");
  // No front end could give it: whole numbers are signed.
  EXPECT_THAT(refusal_of({.seed = 3'000'000'000}), ::testing::StartsWith("ToolOptions::seed is -"));
  EXPECT_EQ(refusal_of({.marks = {{1, 2}, {1, 0}}}),
            "ToolOptions::marks[1].depth is 0; it must be > 0");
}

TEST(Fields, AreCalledInTheWordsOfAFrontEnd) {
  ToolOptions options{.radius = -1};
  try {
    require_in_range(fields_of(options));
    FAIL() << "nothing was thrown";
  } catch (const InvalidInput& error) {
    const auto option = [](const std::string& field) {
      return field == "ToolOptions::radius" ? "--radius" : field;
    };
    EXPECT_EQ(error.with_names(option), "--radius is -1 mm; it must be > 0 and finite");
  }
}

}  // namespace
}  // namespace palpate
