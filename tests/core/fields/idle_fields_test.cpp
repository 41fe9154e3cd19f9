// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/core/idle_fields.h"

#include <gtest/gtest.h>

#include <array>
#include <optional>
#include <string>

#include "palpate/core/error.h"

namespace palpate {
namespace {

constexpr std::array<std::string_view, 2> kWays{"fast", "exact"};
enum class Way { fast, exact };

struct PathOptions {
  Way way = Way::fast;
  bool is_smooth = true;
  double spacing = 1;
  std::optional<double> length = std::nullopt;
};

void visit(PathOptions& options, FieldVisitor& visitor) {
  visitor.begin("PathOptions");
  visitor.choice({"way", "Way of the search"}, options.way, kWays);
  visitor.flag({"is_smooth", "Smooth the path"}, options.is_smooth);
  visitor.real({"spacing", "Spacing of points", "mm"}, options.spacing, above(0));
  visitor.real({"length", "Length of the path", "mm"}, options.length, above(0));
}

std::string refusal_of(const PathOptions& options, std::string_view cause) {
  try {
    refuse_idle(options, cause, {"spacing", "length"});
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return {};
}

TEST(RefuseIdle, NamesBothFieldsAndTheValueOfOne) {
  EXPECT_EQ(refusal_of({.way = Way::exact, .spacing = 2}, "way"),
            "PathOptions::spacing does nothing with PathOptions::way exact");
  EXPECT_EQ(refusal_of({.is_smooth = false, .length = 3}, "is_smooth"),
            "PathOptions::length does nothing with PathOptions::is_smooth (off)");
  EXPECT_EQ(refusal_of({.spacing = 2}, "length"),
            "PathOptions::spacing does nothing with PathOptions::length (not given)");
}

TEST(RefuseIdle, TakesFieldsThatAreNotGiven) {
  EXPECT_EQ(refusal_of({.way = Way::exact}, "way"), "");
  EXPECT_EQ(refusal_of({.way = Way::exact, .is_smooth = false}, "way"), "");
}

}  // namespace
}  // namespace palpate
