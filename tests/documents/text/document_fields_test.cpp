// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/documents/document_fields.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "refusal.h"

namespace palpate::documents {
namespace {

using ::testing::HasSubstr;

enum class Shape { round, square };

struct Cutting {
  double width = 2;
  std::optional<double> depth;
  int steps = 3;
  bool wet = false;
  Shape shape = Shape::round;
};

void visit(Cutting& cutting, FieldVisitor& visitor) {
  using namespace std::string_view_literals;
  static constexpr std::array kShapes{"round"sv, "square"sv};
  visitor.begin("Cutting");
  visitor.real({"width", "Width of a cut", "mm"}, cutting.width, above(0).finite());
  visitor.real({"depth", "Depth of a cut", "mm"}, cutting.depth, at_least(0).finite());
  visitor.whole({"steps", "Steps of a cut"}, cutting.steps, at_least(1));
  visitor.flag({"wet", "Cool with water"}, cutting.wet);
  visitor.choice({"shape", "Shape of a cut"}, cutting.shape, kShapes);
}

Cutting read(const std::string& text) {
  const Document document = parse_yaml(text, "it.yaml");
  Cutting cutting;
  read_fields(DocumentNode(document), fields_of(cutting));
  return cutting;
}

TEST(DocumentFields, SetThoseThatAreThereAndKeepTheOthers) {
  const Cutting cutting = read("shape: square\ndepth: 0.5\nwet: true\n");
  EXPECT_EQ(cutting.width, 2);
  EXPECT_EQ(cutting.depth, 0.5);
  EXPECT_EQ(cutting.steps, 3);
  EXPECT_TRUE(cutting.wet);
  EXPECT_EQ(cutting.shape, Shape::square);
}

TEST(DocumentFields, AreRefusedWithTheirLine) {
  EXPECT_EQ(refusal([] { return read("wet: true\nwidth: 0\n"); }),
            "line 2, at /width: found 0, expected a number > 0 and finite [mm]");
  EXPECT_THAT(refusal([] { return read("steps: 1.5\n"); }), HasSubstr("a whole number >= 1"));
  EXPECT_THAT(refusal([] { return read("wet: 1\n"); }), HasSubstr("true or false"));
  EXPECT_THAT(refusal([] { return read("shape: oval\n"); }), HasSubstr(R"("round" or "square")"));
  EXPECT_THAT(refusal([] { return read("length: 1\n"); }),
              HasSubstr("'length' is unknown; there are width, depth, steps, wet, shape"));
}

}  // namespace
}  // namespace palpate::documents
